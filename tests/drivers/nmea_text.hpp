#pragma once
// NMEA text with right checksums for tests, and what the parser makes of text.

#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/gnss/nmea_parser.hpp"

namespace slamd::test {

/// "GPGGA,..." to "$GPGGA,...*hh\r\n".
inline std::string sentence(std::string_view body) {
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  std::array<char, 4> hex{};
  std::snprintf(hex.data(), hex.size(), "*%02X", sum & 0xFFU);
  return "$" + std::string{body} + hex.data() + "\r\n";
}

inline std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Collects fixes.
struct Fixes {
  NmeaParser parser;
  std::vector<GnssFix> fixes;

  explicit Fixes(const NmeaParser::Config& config = NmeaParser::Config::defaults()) : parser{config} {}
  void feed(std::string_view text, HostTime arrival) {
    parser.feed(bytes_of(text), arrival, [this](const GnssFix& fix) { fixes.push_back(fix); });
  }
  void finish() {
    parser.finish([this](const GnssFix& fix) { fixes.push_back(fix); });
  }
};

}  // namespace slamd::test
