#include "tools/imu-flash/flash_image.hpp"

#include <algorithm>

namespace slamd::flash {
namespace {

constexpr std::size_t kChecksumAt = 252;

/// CRC-32 with polynomial 0x04C11DB7, most significant bit first, no final inversion: the boot ROM's.
std::uint32_t boot_crc(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFF'FFFFU;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<std::uint32_t>(byte) << 24U;
    for (int bit = 0; bit < 8; ++bit) crc = (crc << 1U) ^ ((crc & 0x8000'0000U) != 0 ? 0x04C1'1DB7U : 0U);
  }
  return crc;
}

}  // namespace

bool FlashImage::is_bootable() const {
  if (!has_second_stage()) return false;
  const std::span<const std::uint8_t> page{pages.front().bytes};
  std::uint32_t stored = 0;
  for (std::size_t i = 0; i < 4; ++i) stored |= static_cast<std::uint32_t>(page[kChecksumAt + i]) << (8U * i);
  return stored == boot_crc(page.first(kChecksumAt));
}

std::vector<std::uint32_t> FlashImage::sectors() const {
  std::vector<std::uint32_t> sectors;
  for (const Page& page : pages) {
    const std::uint32_t sector = page.address - page.address % kSectorBytes;
    if (sectors.empty() || sectors.back() != sector) sectors.push_back(sector);
  }
  return sectors;
}

std::vector<Run> FlashImage::runs() const {
  std::vector<Run> runs;
  for (const Page& page : pages) {
    const bool follows = !runs.empty() && page.address == runs.back().address + runs.back().bytes.size();
    if (!follows || page.address % kSectorBytes == 0) runs.push_back({page.address, {}});
    runs.back().bytes.insert(runs.back().bytes.end(), page.bytes.begin(), page.bytes.end());
  }
  return runs;
}

LoadedImage image_of_binary(std::span<const std::uint8_t> file) {
  LoadedImage loaded;
  if (file.empty()) return {{}, "the file is empty"};
  if (file.size() > kFlashBytes) return {{}, "larger than the flash of 16 MiB"};
  for (std::size_t begin = 0; begin < file.size(); begin += kPageBytes) {
    Page page{kFlashBegin + static_cast<std::uint32_t>(begin), {}};
    page.bytes.fill(0xFF);
    std::ranges::copy(file.subspan(begin, std::min<std::size_t>(kPageBytes, file.size() - begin)), page.bytes.begin());
    loaded.image.pages.push_back(page);
  }
  return loaded;
}

}  // namespace slamd::flash
