#pragma once
// UF2 files as bytes for tests and fuzzers of imu-flash, written from the format's description.

#include <cstdint>
#include <span>
#include <vector>

namespace slamd::flash::test {

inline void store_word(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8U * i));
}

inline std::vector<std::uint8_t> image_bytes(std::size_t size) {
  std::vector<std::uint8_t> bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(i * 37 + i / 256);
  return bytes;
}

/// A right UF2 file of `content` from the flash's start on, padded with zeros to whole pages.
inline std::vector<std::uint8_t> uf2_of(std::span<const std::uint8_t> content) {
  const auto count = static_cast<std::uint32_t>((content.size() + 255) / 256);
  std::vector<std::uint8_t> file(std::size_t{count} * 512);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t at = std::size_t{i} * 512;
    const std::uint32_t head[] = {0x0A324655, 0x9E5D5157, 0x2000, 0x10000000 + 256 * i, 256, i, count, 0xE48BFF56};
    for (std::size_t k = 0; k < 8; ++k) store_word(file, at + 4 * k, head[k]);
    for (std::size_t k = 0; k < 256 && 256 * std::size_t{i} + k < content.size(); ++k) {
      file[at + 32 + k] = content[256 * std::size_t{i} + k];
    }
    store_word(file, at + 508, 0x0AB16F30);
  }
  return file;
}

/// Bit by bit, from the catalogue's parameters: polynomial 0x04C11DB7, start all ones.
inline std::uint32_t crc32_mpeg2(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const std::uint8_t byte : bytes) {
    for (int bit = 7; bit >= 0; --bit) {
      const std::uint32_t feedback = (crc >> 31U) ^ ((static_cast<std::uint32_t>(byte) >> bit) & 1U);
      crc = (crc << 1U) ^ (feedback != 0 ? 0x04C11DB7U : 0U);
    }
  }
  return crc;
}

}  // namespace slamd::flash::test
