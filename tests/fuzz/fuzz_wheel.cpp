// Bytes of the wheels' port: any. Properties: any split gives the same odometry; what comes out is finite, in order of time and
// without a jump; a line after any garbage is found; a reading comes back from its line.

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "drivers/wheel/wheel_parser.hpp"

namespace {

using namespace slamd;

void require(bool property) {
  if (!property) std::abort();
}

std::vector<WheelOdometry> parse(std::span<const std::uint8_t> input, bool bytewise) {
  constexpr std::size_t kChunk = 64;
  std::vector<WheelOdometry> found;
  WheelParser parser;
  HostTime arrival{std::chrono::seconds{1}};
  const auto sink = [&](const WheelOdometry& odometry) { found.push_back(odometry); };
  for (std::size_t begin = 0; begin < input.size(); begin += kChunk) {
    arrival += std::chrono::milliseconds{20};
    const auto chunk = input.subspan(begin, std::min(kChunk, input.size() - begin));
    if (!bytewise) parser.feed(chunk, arrival, sink);
    for (std::size_t i = 0; bytewise && i < chunk.size(); ++i) parser.feed(chunk.subspan(i, 1), arrival, sink);
  }
  return found;
}

void check_splits(std::span<const std::uint8_t> input) {
  const std::vector<WheelOdometry> whole = parse(input, false);
  const std::vector<WheelOdometry> bytewise = parse(input, true);
  require(whole.size() == bytewise.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    require(whole[i].time == bytewise[i].time && whole[i].x_m == bytewise[i].x_m && whole[i].yaw_rad == bytewise[i].yaw_rad);
    require(std::isfinite(whole[i].x_m) && std::isfinite(whole[i].y_m) && std::isfinite(whole[i].yaw_rad));
  }
}

void check_found_after(std::span<const std::uint8_t> garbage) {
  WheelParser parser;
  for (const std::uint8_t byte : garbage) parser.take(byte);
  std::optional<WheelReading> found;
  for (const char c : std::string{"\n$WODO,5,1,2,3*16"}) {
    if (const auto reading = parser.take(static_cast<std::uint8_t>(c))) found = reading;
  }
  require(found && found->device_us == 5 && found->yaw_rad == 3.0);
}

/// The input as readings: the fuzzer gets past the lines.
void check_track(std::span<const std::uint8_t> input) {
  WheelTrack track;
  HostTime arrival{std::chrono::seconds{1}};
  for (std::size_t at = 0; at + sizeof(WheelReading) <= input.size(); at += sizeof(WheelReading)) {
    WheelReading reading;
    std::memcpy(&reading, input.data() + at, sizeof(reading));
    arrival += std::chrono::milliseconds{20};
    const auto odometry = track.add(reading, arrival);
    if (odometry) require(is_possible(reading) && std::isfinite(odometry->x_m) && std::isfinite(odometry->yaw_rad));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* input, std::size_t size) {
  const std::span<const std::uint8_t> bytes{input, size};
  check_splits(bytes);
  check_found_after(bytes);
  check_track(bytes);
  return 0;
}
