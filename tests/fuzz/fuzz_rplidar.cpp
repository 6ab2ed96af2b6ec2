// Bytes of an RPLIDAR's port: any. Properties: any split gives the same scans; directions and ranges are within bounds and times in
// order; after any bytes and a reopened port a whole capsule is found; the session asks for nothing that is no request, and for a bounded
// number of things.

#include <cmath>
#include <cstdlib>
#include <vector>

#include "drivers/rplidar/rplidar_parser.hpp"
#include "drivers/rplidar/rplidar_session.hpp"

namespace {

using namespace slamd;

void require(bool property) {
  if (!property) std::abort();
}

void check(const LaserScan& scan) {
  require(!scan.beams.empty() && scan.beams.size() <= RplidarParser::kMaxBeams);
  for (const LaserBeam& beam : scan.beams) {
    require(std::abs(beam.angle_rad) <= 3.15F && std::isfinite(beam.time_s));
    require(beam.range_m == 0.0F || (beam.range_m >= 0.149F && beam.range_m <= scan.range_max_m + 0.001F));
  }
}

std::vector<LaserScan> parse(std::span<const std::uint8_t> input, bool bytewise) {
  constexpr std::size_t kChunk = 132;
  std::vector<LaserScan> scans;
  RplidarParser parser;
  HostTime arrival{std::chrono::seconds{1}};
  const auto sink = [&](const LaserScan& scan) {
    check(scan);
    scans.push_back(scan);
  };
  for (std::size_t begin = 0; begin < input.size(); begin += kChunk) {
    arrival += std::chrono::milliseconds{12};
    const auto chunk = input.subspan(begin, std::min(kChunk, input.size() - begin));
    if (!bytewise) parser.feed(chunk, arrival, sink);
    for (std::size_t i = 0; bytewise && i < chunk.size(); ++i) parser.feed(chunk.subspan(i, 1), arrival, sink);
  }
  return scans;
}

void check_splits(std::span<const std::uint8_t> input) {
  const std::vector<LaserScan> whole = parse(input, false);
  const std::vector<LaserScan> bytewise = parse(input, true);
  require(whole.size() == bytewise.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    require(whole[i].time == bytewise[i].time && whole[i].beams.size() == bytewise[i].beams.size());
  }
}

/// Right checksums for the input's capsules, behind the begin of a boost scan: the fuzzer gets past the reader.
std::vector<std::uint8_t> as_capsules(std::span<const std::uint8_t> input) {
  std::vector<std::uint8_t> bytes{0xA5, 0x5A, 0x84, 0, 0, 0x40, 0x84};
  for (std::size_t at = 0; at + 130 <= input.size(); at += 130) {
    std::uint8_t sum = 0;
    for (const std::uint8_t byte : input.subspan(at, 130)) sum ^= byte;
    bytes.push_back(static_cast<std::uint8_t>(0xA0U | (sum & 0xFU)));
    bytes.push_back(static_cast<std::uint8_t>(0x50U | (sum >> 4U)));
    bytes.insert(bytes.end(), input.begin() + static_cast<std::ptrdiff_t>(at), input.begin() + static_cast<std::ptrdiff_t>(at + 130));
  }
  return bytes;
}

void check_found_after(std::span<const std::uint8_t> garbage) {
  RplidarReader reader;
  for (const std::uint8_t byte : garbage) reader.take(byte);
  reader.restart();
  const std::vector<std::uint8_t> zeros(130);
  std::size_t found = 0;
  for (const std::uint8_t byte : as_capsules(zeros)) {
    const auto packet = reader.take(byte);
    found += packet && packet->bytes.size() == kRplidarBoostBytes ? 1 : 0;
  }
  require(found == 1);
}

void check_session(std::span<const std::uint8_t> input) {
  RplidarSession session;
  RplidarReader reader;
  HostTime now{std::chrono::seconds{1}};
  for (const std::uint8_t byte : input) {
    now += std::chrono::milliseconds{10};
    int asked = 0;
    while (const auto request = session.poll(now)) {
      require(request->size >= 2 && request->bytes[0] == 0xA5);
      require(++asked < 20);
    }
    if (const auto packet = reader.take(byte)) session.take(*packet, now);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* input, std::size_t size) {
  const std::span<const std::uint8_t> bytes{input, size};
  check_splits(bytes);
  check_splits(as_capsules(bytes));
  check_found_after(bytes);
  check_session(bytes);
  return 0;
}
