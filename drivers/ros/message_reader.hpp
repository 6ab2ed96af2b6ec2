#pragma once
// Reads the fields of one serialised ROS message, ROS 1 or ROS 2 (CDR), one after the other and never past its end. It knows how
// fields lie, not which message has which (messages.hpp).

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace slamd {

enum class RosEncoding : std::uint8_t {
  kRos1,  // packed, little-endian
  kCdr    // XCDR1 or plain XCDR2 of either byte order, with the encapsulation header of four bytes
};

/// A cursor over borrowed bytes. Reading past the end, an unknown encapsulation or a length that cannot be gives zeros and makes ok()
/// false for good.
class MessageReader {
 public:
  MessageReader(std::span<const std::uint8_t> bytes, RosEncoding encoding);

  /// An integer or floating-point number, aligned as the encoding wants it.
  template <class Number>
    requires std::integral<Number> || std::floating_point<Number>
  Number number() {
    align(sizeof(Number));
    const auto found = take(sizeof(Number));
    std::array<std::uint8_t, sizeof(Number)> raw{};
    if (found.size() == sizeof(Number)) std::memcpy(raw.data(), found.data(), sizeof(Number));
    if (swaps_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Number>(raw);
  }
  double f64() { return number<double>(); }
  float f32() { return number<float>(); }

  std::string_view text();
  /// builtin time: seconds and nanoseconds, as nanoseconds. Fails on more than a second of nanoseconds or before 1970.
  std::int64_t time_ns();
  /// std_msgs/Header: its stamp. The frame's name is left behind.
  std::int64_t header_stamp_ns();
  /// Length of a sequence whose elements take at least `least_bytes` each; fails when so many cannot follow.
  std::size_t count(std::size_t least_bytes);
  /// A sequence of bytes, borrowed.
  std::span<const std::uint8_t> byte_sequence() { return take(count(1)); }
  /// `count` bytes without alignment: an array of fixed length.
  std::span<const std::uint8_t> take(std::size_t count);
  void skip_f64(std::size_t count);

  RosEncoding encoding() const { return encoding_; }
  bool ok() const { return ok_; }
  /// From the message's first byte: where it went wrong, for the reader of a fault.
  std::size_t position() const { return position_; }

 private:
  void align(std::size_t size);
  void fail();

  std::span<const std::uint8_t> bytes_;
  RosEncoding encoding_;
  std::size_t position_ = 0;
  std::size_t origin_ = 0;         // alignment counts from here
  std::size_t most_alignment_ = 1;
  bool swaps_ = false;             // the other byte order
  bool ok_ = true;
};

}  // namespace slamd
