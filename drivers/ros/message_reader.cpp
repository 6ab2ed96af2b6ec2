#include "drivers/ros/message_reader.hpp"

namespace slamd {
namespace {

constexpr std::size_t kEncapsulationBytes = 4;
constexpr std::int64_t kNsPerSecond = 1'000'000'000;

}  // namespace

MessageReader::MessageReader(std::span<const std::uint8_t> bytes, RosEncoding encoding) : bytes_{bytes}, encoding_{encoding} {
  if (encoding == RosEncoding::kRos1) return;
  const auto head = take(kEncapsulationBytes);
  if (!ok_) return;
  origin_ = kEncapsulationBytes;
  const int scheme = head[0] << 8 | head[1];  // 0, 1: CDR big, little; 6, 7: plain CDR2 big, little
  if (scheme != 0 && scheme != 1 && scheme != 6 && scheme != 7) fail();
  most_alignment_ = scheme < 6 ? 8 : 4;
  swaps_ = (scheme & 1) == 0;
}

std::span<const std::uint8_t> MessageReader::take(std::size_t count) {
  if (count > bytes_.size() - position_) {
    fail();
    return {};
  }
  const auto taken = bytes_.subspan(position_, count);
  position_ += count;
  return taken;
}

void MessageReader::align(std::size_t size) {
  const std::size_t to = std::min(size, most_alignment_);
  const std::size_t over = (position_ - origin_) % to;
  if (over != 0) take(to - over);
}

void MessageReader::fail() {
  ok_ = false;
  bytes_ = bytes_.first(position_);
}

std::string_view MessageReader::text() {
  const auto bytes = byte_sequence();
  std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  if (encoding_ == RosEncoding::kCdr && !text.empty() && text.back() == '\0') text.remove_suffix(1);
  return text;
}

std::int64_t MessageReader::time_ns() {
  const bool is_signed = encoding_ == RosEncoding::kCdr;
  const std::uint32_t raw = number<std::uint32_t>();
  const std::int64_t seconds = is_signed ? static_cast<std::int32_t>(raw) : static_cast<std::int64_t>(raw);
  const std::int64_t nanoseconds = number<std::uint32_t>();
  if (seconds < 0 || nanoseconds >= kNsPerSecond) {
    fail();
    return 0;
  }
  return seconds * kNsPerSecond + nanoseconds;
}

std::int64_t MessageReader::header_stamp_ns() {
  if (encoding_ == RosEncoding::kRos1) number<std::uint32_t>();  // sequence
  const std::int64_t stamp_ns = time_ns();
  text();
  return stamp_ns;
}

std::size_t MessageReader::count(std::size_t least_bytes) {
  const std::size_t count = number<std::uint32_t>();
  if (count > (bytes_.size() - position_) / least_bytes) {
    fail();
    return 0;
  }
  return count;
}

void MessageReader::skip_f64(std::size_t count) {
  for (std::size_t i = 0; i < count && ok_; ++i) f64();
}

}  // namespace slamd
