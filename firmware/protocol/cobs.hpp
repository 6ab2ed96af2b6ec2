#pragma once
// Consistent overhead byte stuffing (Cheshire and Baker 1999): a packet without zero bytes. No delimiter is added here.

#include <cstddef>
#include <cstdint>
#include <span>

namespace slamd {

/// Longest encoding of `size` bytes.
constexpr std::size_t cobs_max_encoded(std::size_t size) {
  return size + size / 254 + 1;
}

/// Encodes `plain` into `encoded`, which holds at least cobs_max_encoded(plain.size()) bytes. Returns the bytes
/// written; none of them is zero. Freestanding, O(size).
constexpr std::size_t cobs_encode(std::span<const std::uint8_t> plain, std::span<std::uint8_t> encoded) {
  std::size_t code_at = 0;
  std::size_t out = 1;
  std::uint8_t code = 1;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    if (plain[i] != 0) {
      encoded[out++] = plain[i];
      ++code;
    }
    const bool block_full = code == 0xFF && i + 1 < plain.size();
    if (plain[i] == 0 || block_full) {
      encoded[code_at] = code;
      code_at = out++;
      code = 1;
    }
  }
  encoded[code_at] = code;
  return out;
}

/// Decodes one packet (without its delimiter) into `plain`. Returns the bytes written; 0 when the packet is empty,
/// malformed, contains a zero or does not fit. Freestanding, O(size).
constexpr std::size_t cobs_decode(std::span<const std::uint8_t> encoded, std::span<std::uint8_t> plain) {
  std::size_t in = 0;
  std::size_t out = 0;
  while (in < encoded.size()) {
    const std::uint8_t code = encoded[in++];
    if (code == 0 || in + code - 1 > encoded.size()) return 0;
    for (std::uint8_t i = 1; i < code; ++i) {
      if (encoded[in] == 0 || out == plain.size()) return 0;
      plain[out++] = encoded[in++];
    }
    if (code != 0xFF && in < encoded.size()) {
      if (out == plain.size()) return 0;
      plain[out++] = 0;
    }
  }
  return out;
}

}  // namespace slamd
