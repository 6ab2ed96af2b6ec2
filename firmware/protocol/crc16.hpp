#pragma once
// CRC-16/CCITT-FALSE (polynomial 0x1021, start 0xFFFF, no reflection, no final xor). No table: 28 bytes at 200 Hz.

#include <cstdint>
#include <span>

namespace slamd {

/// CRC over `bytes`; the check value of "123456789" is 0x29B1. Freestanding, O(bytes).
constexpr std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFFU;
  for (const std::uint8_t byte : bytes) {
    std::uint32_t x = ((crc >> 8U) ^ byte) & 0xFFU;
    x ^= x >> 4U;
    crc = ((crc << 8U) ^ (x << 12U) ^ (x << 5U) ^ x) & 0xFFFFU;
  }
  return static_cast<std::uint16_t>(crc);
}

}  // namespace slamd
