#include "tools/imu-flash/uf2.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

namespace slamd::flash {
namespace {

constexpr std::uint32_t kMagicFirst = 0x0A32'4655;
constexpr std::uint32_t kMagicSecond = 0x9E5D'5157;
constexpr std::uint32_t kMagicEnd = 0x0AB1'6F30;
constexpr std::size_t kPayloadAt = 32;
constexpr std::uint32_t kNotMainFlash = 0x0000'0001;
constexpr std::uint32_t kFileContainer = 0x0000'1000;
constexpr std::uint32_t kHasFamily = 0x0000'2000;

struct Block {
  std::uint32_t magic_first, magic_second, flags, address, payload_bytes, number, count, family, magic_end;
};

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(bytes[at + i]) << (8U * i);
  return value;
}

Block read_block(std::span<const std::uint8_t> bytes) {
  return {word(bytes, 0),  word(bytes, 4),  word(bytes, 8),
          word(bytes, 12), word(bytes, 16), word(bytes, 20),
          word(bytes, 24), word(bytes, 28), word(bytes, kUf2BlockBytes - 4)};
}

std::string hex(std::uint32_t value) {
  char text[11];
  std::snprintf(text, sizeof text, "0x%08x", value);
  return text;
}

/// What is wrong with a block by itself; empty: nothing.
std::string refusal_of(const Block& block, std::size_t blocks_in_file) {
  if (block.magic_first != kMagicFirst || block.magic_second != kMagicSecond || block.magic_end != kMagicEnd) {
    return "wrong magic number: not a UF2 file, or damaged";
  }
  if (block.count != blocks_in_file) {
    return "says the file has " + std::to_string(block.count) + " blocks, it has " + std::to_string(blocks_in_file) +
           ": truncated, or two files in one";
  }
  if (block.number >= block.count) return "block number " + std::to_string(block.number) + " is beyond the block count";
  if ((block.flags & kNotMainFlash) != 0) return {};
  if ((block.flags & kFileContainer) != 0) return "is a part of a packed file, not of a flash image";
  if ((block.flags & kHasFamily) == 0) return "names no family; the RP2040 is " + hex(kUf2FamilyRp2040);
  if (block.family != kUf2FamilyRp2040) {
    return "wrong family id " + hex(block.family) + ": for another chip; the RP2040 is " + hex(kUf2FamilyRp2040);
  }
  if (block.payload_bytes != kPageBytes) {
    return "payload of " + std::to_string(block.payload_bytes) + " bytes; the RP2040 takes 256";
  }
  const bool in_flash = block.address >= kFlashBegin && block.address - kFlashBegin <= kFlashBytes - kPageBytes;
  if (!in_flash) return "address " + hex(block.address) + " is outside of the flash";
  if (block.address % kPageBytes != 0) return "address " + hex(block.address) + " is not a multiple of 256";
  return {};
}

/// Collects blocks and remembers who wrote what.
class Collector {
 public:
  explicit Collector(std::size_t count) : seen_(count, false) {}

  std::string add(const Block& block, std::span<const std::uint8_t> payload) {
    if (seen_[block.number]) return "block number " + std::to_string(block.number) + " comes twice";
    seen_[block.number] = true;
    if ((block.flags & kNotMainFlash) != 0) return {};
    const auto [other, is_new] = owner_.emplace(block.address, block.number);
    if (!is_new) {
      return "overlaps block " + std::to_string(other->second) + " at address " + hex(block.address);
    }
    Page page{block.address, {}};
    std::ranges::copy(payload, page.bytes.begin());
    pages_.push_back(page);
    return {};
  }

  FlashImage image() && {
    std::ranges::sort(pages_, {}, &Page::address);
    return {std::move(pages_)};
  }

 private:
  std::vector<bool> seen_;
  std::map<std::uint32_t, std::uint32_t> owner_;  // address -> block number
  std::vector<Page> pages_;
};

}  // namespace

LoadedImage parse_uf2(std::span<const std::uint8_t> file) {
  if (file.empty()) return {{}, "the file is empty"};
  if (file.size() % kUf2BlockBytes != 0) {
    return {{}, std::to_string(file.size()) + " bytes are no whole number of 512-byte blocks: truncated or not UF2"};
  }
  const std::size_t count = file.size() / kUf2BlockBytes;
  Collector collector{count};
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<const std::uint8_t> bytes = file.subspan(i * kUf2BlockBytes, kUf2BlockBytes);
    const Block block = read_block(bytes);
    std::string refusal = refusal_of(block, count);
    if (refusal.empty()) refusal = collector.add(block, bytes.subspan(kPayloadAt, kPageBytes));
    if (!refusal.empty()) return {{}, "block " + std::to_string(i) + ": " + refusal};
  }
  LoadedImage loaded{std::move(collector).image(), {}};
  if (loaded.image.pages.empty()) loaded.refusal = "has no block for the flash";
  return loaded;
}

}  // namespace slamd::flash
