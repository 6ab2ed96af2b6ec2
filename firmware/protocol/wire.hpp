#pragma once
// Little-endian integers in byte arrays. It is not a stream and checks no bounds: offsets are constants of the layouts.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

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

/// Fields of a layout into bytes: integers of either sign and enums; arrays element after element.
class Writer {
 public:
  constexpr explicit Writer(std::span<std::uint8_t> bytes) : bytes_{bytes} {}

  template <class Field>
  constexpr void operator()(std::size_t at, const Field& field) const {
    store(bytes_, at, static_cast<std::make_unsigned_t<Field>>(field));
  }
  template <class Field, std::size_t N>
  constexpr void operator()(std::size_t at, const std::array<Field, N>& fields) const {
    for (std::size_t i = 0; i < N; ++i) (*this)(at + i * sizeof(Field), fields[i]);
  }

 private:
  std::span<std::uint8_t> bytes_;
};

/// What Writer wrote, back into the fields.
class Reader {
 public:
  constexpr explicit Reader(std::span<const std::uint8_t> bytes) : bytes_{bytes} {}

  template <class Field>
  constexpr void operator()(std::size_t at, Field& field) const {
    field = static_cast<Field>(load<std::make_unsigned_t<Field>>(bytes_, at));
  }
  template <class Field, std::size_t N>
  constexpr void operator()(std::size_t at, std::array<Field, N>& fields) const {
    for (std::size_t i = 0; i < N; ++i) (*this)(at + i * sizeof(Field), fields[i]);
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace slamd::wire
