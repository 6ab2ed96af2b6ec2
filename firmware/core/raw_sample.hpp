#pragma once
// One reading of the sensor's output registers. Sequence, status and units are not its business.

#include <array>
#include <cstdint>
#include <span>

#include "firmware/core/micros.hpp"
#include "firmware/protocol/wire.hpp"

namespace slamd {

struct RawSample {
  Micros stamp = 0;      // data-ready
  bool overrun = false;  // at least one sample before this one was lost
  std::int16_t temperature = 0;
  std::array<std::int16_t, 3> gyro{};
  std::array<std::int16_t, 3> accel{};
};

/// Bytes of the registers from lsm6dsox::kTemperature on: temperature, gyro x y z, accel x y z, low byte first.
constexpr void read_outputs(std::span<const std::uint8_t> bytes, RawSample& sample) {
  const auto value = [bytes](std::size_t at) {
    return static_cast<std::int16_t>(wire::load<std::uint16_t>(bytes, at));
  };
  sample.temperature = value(0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sample.gyro[axis] = value(2 + 2 * axis);
    sample.accel[axis] = value(8 + 2 * axis);
  }
}

}  // namespace slamd
