#pragma once
// What of a map outlives the process: its newest keyframes and their closures, where the vehicle was, what was known of its
// sensors, and where the map lies on the earth. A value without behaviour; bytes and files are daemon/store's.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "estimator/types/pose.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

struct StoredKeyframe {
  HostTime time;
  Pose T_map_base;
  Matrix6d relative_covariance = Matrix6d::Zero();  // as Keyframe's; from the keyframe before it
  std::vector<std::uint8_t> cloud;                  // its points as estimator/graph/packed_cloud packs them
};

/// Map in local East-North-Up, and where that begins (WGS-84).
struct StoredEnu {
  double yaw_rad = 0.0;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  std::array<double, 16> covariance{};  // rows 0-2 translation (m), row 3 yaw (rad); row-major
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double ellipsoid_height_m = 0.0;
};

/// A closure that held; as LoopClosure, its ends by their places among the stored keyframes.
struct StoredClosure {
  std::uint32_t from = 0;  // the earlier one
  std::uint32_t to = 0;
  Pose T_from_to;
  Matrix6d covariance = Matrix6d::Identity();
};

/// What the filter had learnt of its sensors, imu frame.
struct StoredSensors {
  Eigen::Vector3d gyro_bias_rads = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias_mps2 = Eigen::Vector3d::Zero();
  Pose T_imu_lidar;
};

/// How the vehicle moved when the map was left.
struct StoredMotion {
  HostTime time;
  Duration host_to_utc{};                                           // UTC less the host's clock, as it was then
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();           // of base, in base
  Eigen::Vector3d angular_velocity_rads = Eigen::Vector3d::Zero();  // likewise
};

struct StoredMap {
  std::vector<StoredKeyframe> keyframes;  // in order of time
  std::vector<StoredClosure> closures;    // between them
  Pose T_map_base;                        // where the vehicle was
  std::optional<StoredMotion> motion;     // and how it moved
  StoredSensors sensors;
  bool enu_valid = false;                 // false: enu says nothing
  StoredEnu enu;
};

/// What a stored map has gained since: one keyframe, tied to the one before it by odometry.
struct StoredStep {
  HostTime time;
  Pose T_before_this;
  Matrix6d relative_covariance = Matrix6d::Zero();
  std::vector<std::uint8_t> cloud;
  StoredMotion motion;
  StoredSensors sensors;
};

}  // namespace slamd
