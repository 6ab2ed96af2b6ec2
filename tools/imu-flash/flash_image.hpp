#pragma once
// What is to stand in the RP2040's flash: pages at addresses, each at most once. Not a file format (uf2) and not the
// way into the chip (flasher).

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace slamd::flash {

constexpr std::uint32_t kFlashBegin = 0x1000'0000;  // where the RP2040 maps it
constexpr std::uint32_t kFlashBytes = 16U << 20U;   // AT25SF128A and IS25LP128F: 128 Mbit
constexpr std::uint32_t kPageBytes = 256;           // the smallest unit that is written,
constexpr std::uint32_t kSectorBytes = 4096;        // and erased

struct Page {
  std::uint32_t address = 0;  // a multiple of kPageBytes within the flash
  std::array<std::uint8_t, kPageBytes> bytes{};
};

/// Pages that follow each other within one sector: what one command writes or reads.
struct Run {
  std::uint32_t address = 0;
  std::vector<std::uint8_t> bytes;
};

struct FlashImage {
  std::vector<Page> pages;  // sorted by address, no address twice

  /// The first page of the flash is the second stage of the boot; the ROM starts it only when its checksum is right.
  bool has_second_stage() const { return !pages.empty() && pages.front().address == kFlashBegin; }
  /// CRC-32 of its first 252 bytes (data sheet 2.8.1.3.1) against the last four; false without a second stage.
  bool is_bootable() const;
  std::vector<std::uint32_t> sectors() const;
  std::vector<Run> runs() const;
};

/// An image, or the reason why the file is refused.
struct LoadedImage {
  FlashImage image;
  std::string refusal;  // empty: the image is good
  explicit operator bool() const { return refusal.empty(); }
};

/// A raw binary that begins at the flash's first byte; the last page is filled up with 0xFF.
LoadedImage image_of_binary(std::span<const std::uint8_t> file);

}  // namespace slamd::flash
