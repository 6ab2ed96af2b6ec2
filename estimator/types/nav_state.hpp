#pragma once
// What slamd says of the vehicle at one instant: pose, twist, covariance, status. The filter's inner state is not here.

#include <array>
#include <cstdint>

#include "estimator/types/pose.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

enum class TrackingStatus : std::uint8_t { kInitialising, kTracking, kDegraded, kLost };

/// Why the status is not kTracking: bits of NavState::reasons. Numbers are part of the protocol and never reused.
enum class StatusReason : std::uint32_t {
  kNoImu = 1U << 0,            // no IMU sample for longer than config says; constant-velocity model in use
  kNoLidar = 1U << 1,          // no scan for longer than config says; dead reckoning
  kImuGap = 1U << 2,           // samples missing inside the last scan
  kImuClipped = 1U << 3,       // acceleration or rate beyond the sensor's range
  kDegenerateTranslation = 1U << 4,  // the scan does not constrain a direction of position (see degenerate_direction)
  kDegenerateRotation = 1U << 5,     // likewise an axis of rotation
  kFewInliers = 1U << 6,       // too few correspondences: the scan was not fused
  kInnovation = 1U << 7,       // scan and prediction disagree beyond the gate
  kHighUncertainty = 1U << 8,  // pose covariance beyond what config calls usable
  kClockUnsure = 1U << 9,      // a device's clock jumped or is not yet locked
  kReset = 1U << 10,           // the filter was restarted; odom has a new origin
  kLidarIncomplete = 1U << 11, // part of the revolution was lost
  kRelocalising = 1U << 12,    // where odom lies in the existing map is not known yet: the pose in map is a guess
  kImuContradicted = 1U << 13, // the scan tells another motion than the IMU and was fused without it
};

constexpr std::uint32_t bit(StatusReason r) { return static_cast<std::uint32_t>(r); }

/// A short English name for logs, JSON and reports ("no_imu", ...).
const char* name(TrackingStatus status);
const char* name(StatusReason reason);

struct NavState {
  HostTime time;                                                 // the instant that all below describes
  std::uint32_t odom_piece = 0;  // counts beginnings of odom: poses of two pieces have no odom in common
  Pose T_odom_base;
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();        // of base, in odom
  Eigen::Vector3d angular_velocity_rads = Eigen::Vector3d::Zero();  // of base, in base
  /// Of T_odom_base: rows 0-2 position error in odom (m), rows 3-5 attitude error, right perturbation in base (rad).
  Matrix6d covariance = Matrix6d::Zero();
  Eigen::Vector3d gyro_bias_rads = Eigen::Vector3d::Zero();      // imu frame
  Eigen::Vector3d accel_bias_mps2 = Eigen::Vector3d::Zero();     // imu frame
  Pose T_imu_lidar;                                              // as configured, unless the filter estimates it
  TrackingStatus status = TrackingStatus::kInitialising;
  std::uint32_t reasons = 0;                                     // bits of StatusReason
  Eigen::Vector3d degenerate_direction = Eigen::Vector3d::Zero();  // unit, odom; zero when all are constrained
  float lidar_test_ratio = 0.0F;  // innovation^2 / gate^2 of the newest scan; > 1 = rejected
};

}  // namespace slamd
