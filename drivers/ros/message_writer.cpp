#include "drivers/ros/message_writer.hpp"

namespace slamd {

MessageWriter& MessageWriter::text(std::string_view text) {
  const bool ends_with_zero = encoding_ == RosEncoding::kCdr;
  count(text.size() + (ends_with_zero ? 1 : 0));
  raw({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  if (ends_with_zero) bytes_.push_back(0);
  return *this;
}

MessageWriter& MessageWriter::time_ns(std::int64_t time_ns) {
  constexpr std::int64_t kNsPerSecond = 1'000'000'000;
  return put(static_cast<std::uint32_t>(time_ns / kNsPerSecond)).put(static_cast<std::uint32_t>(time_ns % kNsPerSecond));
}

MessageWriter& MessageWriter::header(std::int64_t stamp_ns, std::string_view frame) {
  if (encoding_ == RosEncoding::kRos1) put(std::uint32_t{0});  // sequence
  return time_ns(stamp_ns).text(frame);
}

MessageWriter& MessageWriter::raw(std::span<const std::uint8_t> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  return *this;
}

}  // namespace slamd
