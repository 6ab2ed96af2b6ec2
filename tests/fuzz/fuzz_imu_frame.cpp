// IMU byte stream: any bytes. Properties: a frame that comes out stood in the stream byte for byte; a frame that is
// sent after any garbage and a delimiter is found, without that delimiter the one after it; a running stream that was
// disturbed gives samples again, and only those that were sent; samples are finite.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "drivers/imu/imu_frame_parser.hpp"
#include "drivers/imu/imu_scale.hpp"
#include "tests/support/imu_frames.hpp"

namespace {

using namespace slamd;
using test::frame_of;

void require(bool property) {
  if (!property) std::abort();
}

/// Only what was encoded comes out.
void check_frames(ImuFrameParser& parser, std::span<const std::uint8_t> stream) {
  for (std::size_t i = 0; i < stream.size(); ++i) {
    const auto frame = parser.take(stream[i]);
    if (!frame) continue;
    const auto wire = encode(*frame);
    require(i + 1 >= wire.size());
    require(std::equal(wire.begin(), wire.end(), stream.begin() + static_cast<std::ptrdiff_t>(i + 1 - wire.size())));
  }
}

void check_found_after(ImuFrameParser& parser, const ImuFrame& sent) {
  parser.take(kImuFrameDelimiter);
  const auto wire = encode(sent);
  std::optional<ImuFrame> found;
  for (const std::uint8_t byte : wire) found = parser.take(byte);
  require(found && *found == sent);
}

void check_samples(std::span<const std::uint8_t> stream) {
  ImuFrameParser parser;
  HostTime arrival{std::chrono::seconds{1}};
  for (std::size_t begin = 0; begin < stream.size(); begin += 32) {
    arrival += std::chrono::milliseconds{5};
    parser.feed(stream.subspan(begin, std::min<std::size_t>(32, stream.size() - begin)), arrival,
                [&](const ImuSample& s) {
                  require(s.gyro_rads.allFinite() && s.accel_mps2.allFinite() && s.arrival == arrival);
                });
  }
}

/// Whatever came before, without a delimiter of its own: at most the first of two frames is lost.
void check_resync(std::span<const std::uint8_t> stream) {
  ImuFrameParser parser;
  for (const std::uint8_t byte : stream) parser.take(byte);
  const bool clean = stream.empty() || stream.back() == kImuFrameDelimiter;
  ImuFrame frame;
  for (frame.sequence = 1; frame.sequence <= 2; ++frame.sequence) {
    std::optional<ImuFrame> found;
    for (const std::uint8_t byte : encode(frame)) found = parser.take(byte);
    require((found && *found == frame) || (frame.sequence == 1 && !clean));
  }
}

/// A running stream, 200 Hz, with `disturbance` in its middle: truncated, merged or replaced frames. The bytes may hold
/// whole frames with stamps of their own, which the parser may take for a reset of the device: the third frame behind
/// them gives a sample at the latest, and it has the counts that were sent.
void check_recovery(std::span<const std::uint8_t> disturbance, std::size_t cut) {
  ImuFrameParser parser;
  HostTime arrival{std::chrono::seconds{1}};
  std::optional<ImuSample> sample;
  const auto give = [&](std::span<const std::uint8_t> bytes) {
    sample.reset();
    arrival += std::chrono::milliseconds{5};
    parser.feed(bytes, arrival, [&](const ImuSample& s) { sample = s; });
  };
  ImuFrame frame;
  const auto next_wire = [&frame] {
    ++frame.sequence;
    frame.device_us += 5000;
    frame.gyro[0] = static_cast<std::int16_t>(frame.sequence);
    return encode(frame);
  };
  for (int i = 0; i < 4; ++i) {
    give(next_wire());
    require(sample.has_value());
  }
  const auto broken = next_wire();
  give(std::span{broken}.first(cut % broken.size()));
  give(disturbance);
  for (int i = 0; i < 3; ++i) give(next_wire());
  require(sample && std::abs(sample->gyro_rads.x() - frame.gyro[0] * kGyroRadsPerLsb) < 1e-9);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* input, std::size_t size) {
  const std::span<const std::uint8_t> stream{input, size};
  ImuFrameParser parser;
  check_frames(parser, stream);
  check_found_after(parser, frame_of(stream));
  check_samples(stream);
  check_resync(stream);
  check_recovery(stream, size > 0 ? input[0] : 0);

  // the input's bytes between frames of its own: garbage, cuts and merges around the real thing
  std::vector<std::uint8_t> mixed;
  ImuFrame frame = frame_of(stream);
  for (std::size_t begin = 0; begin < size && begin < 512; begin += 24) {
    const auto wire = encode(frame);
    mixed.insert(mixed.end(), wire.begin(), wire.end() - static_cast<std::ptrdiff_t>(input[begin] % 3));
    mixed.insert(mixed.end(), input + begin, input + std::min(size, begin + input[begin] % 24));
    ++frame.sequence;
    frame.device_us += 5000;
  }
  ImuFrameParser second;
  check_frames(second, mixed);
  check_samples(mixed);
  return 0;
}
