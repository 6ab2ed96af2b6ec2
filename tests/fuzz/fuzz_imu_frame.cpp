// IMU byte stream: any bytes. Properties: a frame that comes out stood in the stream byte for byte; a frame that is
// sent after any garbage and a delimiter is found; samples are finite.

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "drivers/imu/imu_frame_parser.hpp"
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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* input, std::size_t size) {
  const std::span<const std::uint8_t> stream{input, size};
  ImuFrameParser parser;
  check_frames(parser, stream);
  check_found_after(parser, frame_of(stream));
  check_samples(stream);

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
