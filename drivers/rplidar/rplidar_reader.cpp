#include "drivers/rplidar/rplidar_reader.hpp"

#include <algorithm>

namespace slamd {
namespace {

constexpr std::uint8_t kBegin1 = 0xA5;
constexpr std::uint8_t kBegin2 = 0x5A;
constexpr std::size_t kChecksummedFrom = 2;  // of a capsule

/// Sync nibbles A and 5.
bool begins_capsule(std::span<const std::uint8_t> bytes) {
  return bytes[0] >> 4U == 0xA && (bytes.size() < 2 || bytes[1] >> 4U == 0x5);
}

/// Start flag and its inverse differ, and the check bit is set.
bool begins_node(std::span<const std::uint8_t> bytes) {
  const bool flags = ((bytes[0] ^ (bytes[0] >> 1U)) & 1U) != 0;
  return flags && (bytes.size() < 2 || (bytes[1] & 1U) != 0);
}

bool sum_is_right(std::span<const std::uint8_t> capsule) {
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : capsule.subspan(kChecksummedFrom)) sum ^= byte;
  return sum == ((capsule[0] & 0x0FU) | ((capsule[1] & 0x0FU) << 4U));
}

/// The begin of a descriptor, as far as there are bytes.
bool begins_descriptor(std::span<const std::uint8_t> bytes) {
  return bytes[0] == kBegin1 && (bytes.size() < 2 || bytes[1] == kBegin2);
}

}  // namespace

void RplidarReader::restart() {
  size_ = 0;
  awaited_.reset();
  stream_.reset();
}

void RplidarReader::drop(std::size_t bytes) {
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(bytes), buffer_.begin() + static_cast<std::ptrdiff_t>(size_), buffer_.begin());
  size_ -= bytes;
}

/// A descriptor of its exact form ends a stream: a capsule that looks like one by chance comes once in 2^40.
std::optional<RplidarPacket> RplidarReader::try_descriptor() {
  const auto found = parse_rplidar_descriptor(std::span<const std::uint8_t, kRplidarDescriptorBytes>{buffer_.data(), kRplidarDescriptorBytes});
  if (!found) return std::nullopt;
  drop(kRplidarDescriptorBytes);
  (found->is_stream ? stream_ : awaited_) = found;
  if (!found->is_stream) return std::nullopt;
  return RplidarPacket{found->answer, {}};
}

std::optional<RplidarPacket> RplidarReader::try_answer() {
  if (size_ < awaited_->size) return std::nullopt;
  std::copy_n(buffer_.begin(), awaited_->size, given_.begin());
  const RplidarPacket packet{awaited_->answer, std::span{given_}.first(awaited_->size)};
  drop(awaited_->size);
  awaited_.reset();
  ++stats_.answers;
  return packet;
}

bool RplidarReader::is_packet() const {
  const auto bytes = std::span{buffer_}.first(size_);
  return stream_->answer == RplidarAnswer::kScan ? begins_node(bytes) : begins_capsule(bytes);
}

std::optional<RplidarPacket> RplidarReader::try_stream() {
  const auto bytes = std::span{buffer_}.first(stream_->size);
  if (stream_->answer != RplidarAnswer::kScan && !sum_is_right(bytes)) {
    ++stats_.bad_checksum;
    ++stats_.garbage_bytes;
    drop(1);
    return std::nullopt;
  }
  std::copy(bytes.begin(), bytes.end(), given_.begin());
  drop(stream_->size);
  ++stats_.packets;
  return RplidarPacket{stream_->answer, std::span{given_}.first(stream_->size)};
}

std::optional<RplidarPacket> RplidarReader::take(std::uint8_t byte) {
  buffer_[size_++] = byte;
  if (awaited_) return try_answer();
  while (size_ > 0) {
    const auto bytes = std::span{buffer_}.first(size_);
    const bool may_be_descriptor = begins_descriptor(bytes);
    if (may_be_descriptor && size_ < kRplidarDescriptorBytes) return std::nullopt;
    if (may_be_descriptor) {
      const std::size_t before = size_;
      if (const auto begun = try_descriptor()) return begun;
      if (size_ != before) return awaited_ ? try_answer() : std::nullopt;
    }
    if (stream_ && is_packet()) {
      if (size_ < stream_->size) return std::nullopt;
      if (const auto packet = try_stream()) return packet;
      continue;
    }
    ++stats_.garbage_bytes;
    drop(1);
  }
  return std::nullopt;
}

}  // namespace slamd
