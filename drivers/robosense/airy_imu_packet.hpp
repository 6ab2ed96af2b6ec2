#pragma once
// One packet of the IMU that is built into an Airy, to SI units in the IMU's own frame. It maps no time to the host's. Source: Airy
// User Guide 1.2, "IMU data packet".

#include <cstdint>
#include <span>

#include "estimator/types/imu_sample.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

constexpr std::size_t kAiryImuBytes = 51;

struct AiryImuReading {
  DeviceTime stamp;
  Eigen::Vector3d gyro_rads;
  Eigen::Vector3d accel_mps2;
  bool clipped = false;     // any axis at the end of the range that the packet names
};

/// Reads the payload of the IMU port. Fails on another size or header, a stamp that is none, ranges that do not exist and values
/// beyond their range. Pure.
Result<AiryImuReading> parse_airy_imu(std::span<const std::uint8_t> payload);

}  // namespace slamd
