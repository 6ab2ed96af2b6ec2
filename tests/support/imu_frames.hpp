#pragma once
// IMU frames out of arbitrary bytes, for random and fuzzed streams. Not the wire's encoding: that is firmware/protocol.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "firmware/protocol/imu_frame.hpp"

namespace slamd::test {

/// A frame whose fields are the first 26 bytes of the input; missing ones are zero.
inline ImuFrame frame_of(std::span<const std::uint8_t> input) {
  std::array<std::uint8_t, 26> bytes{};
  std::copy_n(input.begin(), std::min(input.size(), bytes.size()), bytes.begin());
  ImuFrame frame;
  frame.status = bytes[0];
  frame.sequence = wire::load<std::uint16_t>(bytes, 1);
  frame.device_us = wire::load<std::uint64_t>(bytes, 3);
  for (std::size_t i = 0; i < 3; ++i) {
    frame.gyro[i] = static_cast<std::int16_t>(wire::load<std::uint16_t>(bytes, 11 + 2 * i));
    frame.accel[i] = static_cast<std::int16_t>(wire::load<std::uint16_t>(bytes, 17 + 2 * i));
  }
  frame.temperature = static_cast<std::int16_t>(wire::load<std::uint16_t>(bytes, 23));
  return frame;
}

}  // namespace slamd::test
