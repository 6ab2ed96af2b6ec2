#pragma once
// Little-endian integers in byte arrays. It is not a stream and checks no bounds: offsets are constants of the layouts.

#include <cstddef>
#include <cstdint>
#include <span>

namespace slamd::wire {

/// Writes `value` at offset `at`, lowest byte first. U is unsigned.
template <class U>
constexpr void store(std::span<std::uint8_t> bytes, std::size_t at, U value) {
  for (std::size_t i = 0; i < sizeof(U); ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8U * i));
}

/// Reads what store() wrote.
template <class U>
constexpr U load(std::span<const std::uint8_t> bytes, std::size_t at) {
  U value = 0;
  for (std::size_t i = 0; i < sizeof(U); ++i)
    value = static_cast<U>(value | (static_cast<U>(bytes[at + i]) << (8U * i)));
  return value;
}

}  // namespace slamd::wire
