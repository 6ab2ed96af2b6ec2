#pragma once
// Raw counts of the IMU to SI units, and what counts as clipped or impossible. Scales come from the wire's contract.

#include <numbers>

#include "firmware/protocol/imu_frame.hpp"

namespace slamd {

constexpr double kStandardGravityMps2 = 9.80665;
constexpr double kGyroRadsPerLsb = kImuGyroMdpsPerLsb * 1e-3 * std::numbers::pi / 180.0;
constexpr double kAccelMps2PerLsb = kImuAccelMgPerLsb * 1e-3 * kStandardGravityMps2;

/// At or beyond: the axis stood at the end of its range (int16 of the wire, less one count for rounding in text files).
constexpr double kGyroClipRads = 32766.0 * kGyroRadsPerLsb;
constexpr double kAccelClipMps2 = 32766.0 * kAccelMps2PerLsb;

/// Beyond: no MEMS sensor of this class says that; the sample is rejected. +-4000 dps, +-32 g.
constexpr double kGyroImpossibleRads = 4000.0 * std::numbers::pi / 180.0;
constexpr double kAccelImpossibleMps2 = 32.0 * kStandardGravityMps2;

}  // namespace slamd
