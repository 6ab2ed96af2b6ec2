// NMEA byte stream: any bytes. Properties: any split gives the same fixes; a sentence after any garbage is found; fixes
// are finite, on the earth and of a sigma within the bounds.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "drivers/gnss/nmea_parser.hpp"

namespace {

using namespace slamd;

void require(bool property) {
  if (!property) std::abort();
}

void check_fix(const GnssFix& fix) {
  require(std::abs(fix.latitude_deg) <= 90.0 && std::abs(fix.longitude_deg) <= 180.0);
  require(std::isfinite(fix.height_m) && std::isfinite(fix.speed_mps) && std::isfinite(fix.course_deg));
  require(fix.sigma_horizontal_m >= 1.0 && fix.sigma_horizontal_m <= 5.0);
  require(fix.sigma_vertical_m >= 1.0 && fix.sigma_vertical_m <= 9.0);
  require(fix.quality != GnssQuality::kNone);
}

/// The input's lines arrive in chunks; what arrives at one time may be split in any way.
std::vector<GnssFix> parse(std::span<const std::uint8_t> input, bool bytewise) {
  constexpr std::size_t kChunk = 64;
  std::vector<GnssFix> fixes;
  NmeaParser parser;
  HostTime arrival{std::chrono::seconds{1}};
  const auto sink = [&](const GnssFix& fix) {
    check_fix(fix);
    fixes.push_back(fix);
  };
  for (std::size_t begin = 0; begin < input.size(); begin += kChunk) {
    arrival += std::chrono::milliseconds{300};
    const auto chunk = input.subspan(begin, std::min(kChunk, input.size() - begin));
    if (!bytewise) parser.feed(chunk, arrival, sink);
    for (std::size_t i = 0; bytewise && i < chunk.size(); ++i) parser.feed(chunk.subspan(i, 1), arrival, sink);
  }
  parser.finish(sink);
  return fixes;
}

void check_found_after(std::span<const std::uint8_t> garbage) {
  NmeaTokenizer tokenizer;
  for (const std::uint8_t byte : garbage) tokenizer.take(byte);
  bool found = false;
  for (const char c : std::string{"$GPGGA,x*02"}) {
    const auto sentence = tokenizer.take(static_cast<std::uint8_t>(c));
    found = sentence && sentence->type == NmeaType::kGga && sentence->field(0) == "x";
  }
  require(found);
}

/// Right checksums for the input's lines: the fuzzer gets past the tokenizer.
std::vector<std::uint8_t> with_checksums(std::span<const std::uint8_t> input) {
  std::vector<std::uint8_t> text;
  std::uint8_t sum = 0;
  text.push_back('$');
  for (const std::uint8_t byte : input) {
    if (byte == '*' || byte == '$') continue;
    if (byte != '\n') {
      text.push_back(byte);
      sum ^= byte;
      continue;
    }
    std::array<char, 8> tail{};
    std::snprintf(tail.data(), tail.size(), "*%02X\r\n$", sum);
    for (const char* c = tail.data(); *c != '\0'; ++c) text.push_back(static_cast<std::uint8_t>(*c));
    sum = 0;
  }
  return text;
}

void check_splits(std::span<const std::uint8_t> input) {
  const std::vector<GnssFix> whole = parse(input, false);
  const std::vector<GnssFix> bytewise = parse(input, true);
  require(whole.size() == bytewise.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    require(whole[i].time == bytewise[i].time && whole[i].latitude_deg == bytewise[i].latitude_deg);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* input, std::size_t size) {
  const std::span<const std::uint8_t> bytes{input, size};
  check_found_after(bytes);
  check_splits(bytes);
  check_splits(with_checksums(bytes));
  return 0;
}
