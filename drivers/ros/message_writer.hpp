#pragma once
// Serialises the fields of one ROS message, one after the other: the counterpart of message_reader.hpp, little-endian.

#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/ros/message_reader.hpp"

namespace slamd {

class MessageWriter {
 public:
  explicit MessageWriter(RosEncoding encoding = RosEncoding::kCdr) : encoding_{encoding} {
    if (encoding == RosEncoding::kCdr) bytes_ = {0, 1, 0, 0};  // CDR, little-endian
  }

  template <class Number>
    requires std::integral<Number> || std::floating_point<Number>
  MessageWriter& put(Number number) {
    static_assert(std::endian::native == std::endian::little);
    if (encoding_ == RosEncoding::kCdr) bytes_.resize(4 + (bytes_.size() - 4 + sizeof(Number) - 1) / sizeof(Number) * sizeof(Number));
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof(Number));
    std::memcpy(bytes_.data() + at, &number, sizeof(Number));
    return *this;
  }
  template <class Numbers>
  MessageWriter& put_all(const Numbers& numbers) {
    for (const auto number : numbers) put(number);
    return *this;
  }

  MessageWriter& text(std::string_view text);
  /// Not before 1970.
  MessageWriter& time_ns(std::int64_t time_ns);
  /// std_msgs/Header.
  MessageWriter& header(std::int64_t stamp_ns, std::string_view frame);
  /// Length of the sequence that follows.
  MessageWriter& count(std::size_t count) { return put(static_cast<std::uint32_t>(count)); }
  /// Without length and alignment.
  MessageWriter& raw(std::span<const std::uint8_t> bytes);
  MessageWriter& byte_sequence(std::span<const std::uint8_t> bytes) { return count(bytes.size()).raw(bytes); }

  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  RosEncoding encoding_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace slamd
