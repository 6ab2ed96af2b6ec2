#pragma once
// The order in which an image is brought into the flash, so that the board can be flashed again whatever happens on the
// way. It speaks to the boot loader only and does not find boards.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/imu-flash/flash_image.hpp"
#include "tools/imu-flash/picoboot_client.hpp"

namespace slamd::flash {

enum class Step : std::uint8_t { kErase, kWrite, kVerify };
const char* name(Step step);

/// Told after each piece; bytes of this step done and in all. Returning false stops before the next piece.
using FlashProgress = std::function<bool(Step, std::size_t done, std::size_t total)>;

/// Empty text: all went well.
struct FlashOutcome {
  std::string failure;
  explicit operator bool() const { return failure.empty(); }
};

/// The ROM starts the flash only when the checksum of its first page is right. That page's sector is erased first of
/// all, and the page written last, after everything else was read back: up to then every reset, unplugging and fault
/// leads to the boot loader. Image and client must outlive the flasher.
class Flasher {
 public:
  Flasher(PicobootClient& client, const FlashImage& image, FlashProgress progress);

  /// Erases, writes, reads back and compares.
  FlashOutcome write();
  /// Reads back and compares; changes nothing.
  FlashOutcome verify();

 private:
  FlashOutcome begin();
  FlashOutcome erase_all();
  FlashOutcome write_runs(const std::vector<Run>& runs);
  FlashOutcome compare_runs(const std::vector<Run>& runs);
  FlashOutcome advance(Step step, std::size_t bytes);

  PicobootClient& client_;
  const FlashImage& image_;
  FlashProgress progress_;
  std::size_t done_[3] = {0, 0, 0};  // bytes of each step
};

}  // namespace slamd::flash
