#pragma once
// What an Airy tells about itself once a second or so (DIFOP): the directions of its beams as calibrated, how it is set, where its
// IMU sits. It decodes no points. Source: Airy User Guide 1.2, chapter on DIFOP.

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>

#include "drivers/robosense/airy_packet.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

constexpr std::size_t kAiryDeviceBytes = 1248;

struct AiryDevice {
  std::uint16_t rpm = 0;  // that it is set to
  std::uint8_t return_mode = 0;
  std::array<std::uint8_t, 6> serial{};
  std::array<std::int16_t, kAiryChannels> elevation_cdeg{};      // of each channel, -9000..9000
  std::array<std::int16_t, kAiryChannels> azimuth_offset_cdeg{};  // what it looks further clockwise than its column says
  bool has_imu_pose = false;
  Eigen::Quaterniond R_lidar_imu = Eigen::Quaterniond::Identity();  // p_lidar = R_lidar_imu * p_imu + t_lidar_imu
  Eigen::Vector3d t_lidar_imu = Eigen::Vector3d::Zero();            // metres
};

/// Reads the payload of the device port. Fails on another size, header or tail, and on angles that are missing (a sensor that is
/// not calibrated) or beyond 90 degrees. Without a believable pose of the IMU has_imu_pose is false. Pure.
Result<AiryDevice> parse_airy_device(std::span<const std::uint8_t> payload);

}  // namespace slamd
