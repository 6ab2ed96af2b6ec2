#pragma once
// Reads integers of either byte order out of bytes that came from outside, never past their end. It does not copy, and
// it knows no format.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace slamd {

/// A cursor over borrowed bytes. Reading past the end gives zeros and makes ok() false for good, so that a parser may
/// read a whole header first and ask once.
class ByteReader {
 public:
  explicit constexpr ByteReader(std::span<const std::uint8_t> bytes) : bytes_{bytes} {}

  constexpr std::uint8_t u8() { return big<std::uint8_t>(); }
  constexpr std::uint16_t u16_le() { return little<std::uint16_t>(); }
  constexpr std::uint32_t u32_le() { return little<std::uint32_t>(); }
  constexpr std::uint64_t u64_le() { return little<std::uint64_t>(); }
  constexpr std::uint16_t u16_be() { return big<std::uint16_t>(); }
  constexpr std::uint32_t u32_be() { return big<std::uint32_t>(); }
  constexpr std::uint64_t u64_be() { return big<std::uint64_t>(); }

  /// The next `count` bytes; empty (and not ok) when there are fewer.
  constexpr std::span<const std::uint8_t> take(std::size_t count) {
    if (count > bytes_.size() - position_) {
      fail();
      return {};
    }
    const auto taken = bytes_.subspan(position_, count);
    position_ += count;
    return taken;
  }
  constexpr void skip(std::size_t count) { (void)take(count); }

  constexpr bool ok() const { return ok_; }
  constexpr std::size_t position() const { return position_; }
  constexpr std::size_t remaining() const { return bytes_.size() - position_; }

 private:
  constexpr void fail() {
    ok_ = false;
    position_ = bytes_.size();
  }
  template <std::unsigned_integral T>
  constexpr T little() {
    const auto b = take(sizeof(T));
    T value = 0;
    for (std::size_t i = b.size(); i-- > 0;) value = static_cast<T>((std::uint64_t{value} << 8U) | b[i]);
    return value;
  }
  template <std::unsigned_integral T>
  constexpr T big() {
    T value = 0;
    for (const std::uint8_t byte : take(sizeof(T))) value = static_cast<T>((std::uint64_t{value} << 8U) | byte);
    return value;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

}  // namespace slamd
