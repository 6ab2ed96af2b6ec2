#pragma once
// The filter's full state, its error state's layout, and the pair of operators that joins them. No measurement here.

#include "estimator/math/lie.hpp"
#include "estimator/types/pose.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

/// Standard gravity's magnitude; the filter estimates only the direction (2 of 3 degrees of freedom).
inline constexpr double kGravity_mps2 = 9.80665;

/// Rows of the error state. Attitude and extrinsic rotation are right perturbations: R <- R Exp(d).
struct ErrorIndex {
  static constexpr int kAttitude = 0;             // 3, rad, imu frame
  static constexpr int kPosition = 3;             // 3, m, odom
  static constexpr int kExtrinsicRotation = 6;    // 3, rad, lidar frame
  static constexpr int kExtrinsicTranslation = 9; // 3, m, imu frame
  static constexpr int kVelocity = 12;            // 3, m/s, odom
  static constexpr int kGyroBias = 15;            // 3, rad/s
  static constexpr int kAccelBias = 18;           // 3, m/s^2
  static constexpr int kGravity = 21;             // 2, rad, tangent of the gravity vector
  static constexpr int kSize = 23;
  static constexpr int kMeasured = 12;            // a LiDAR residual depends on the first twelve only
};

using ErrorVector = Eigen::Matrix<double, ErrorIndex::kSize, 1>;
using ErrorCovariance = Eigen::Matrix<double, ErrorIndex::kSize, ErrorIndex::kSize>;

struct InertialState {
  Eigen::Quaterniond R_odom_imu = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_odom_imu = Eigen::Vector3d::Zero();       // m
  Eigen::Vector3d v_odom_imu = Eigen::Vector3d::Zero();       // m/s
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();        // rad/s, imu
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();       // m/s^2, imu
  Eigen::Vector3d gravity = {0.0, 0.0, -kGravity_mps2};       // m/s^2, odom
  Pose T_imu_lidar;

  Pose T_odom_imu() const { return {R_odom_imu, p_odom_imu}; }
  Pose T_odom_lidar() const { return T_odom_imu() * T_imu_lidar; }
};

/// state [+] error.
InertialState boxplus(const InertialState& state, const ErrorVector& error);
/// error with boxplus(from, error) = to.
ErrorVector boxminus(const InertialState& to, const InertialState& from);
/// J with boxminus(boxplus(boxplus(from, e), d), from) = e + J d + O(d^2): block diagonal, inverse right Jacobians.
/// The gravity block is the identity, exact to the first order of its own (milliradian) error.
ErrorCovariance boxminus_jacobian(const ErrorVector& e);

/// An earlier pose of the IMU, the covariance of its error, and what that error shares with the state's (filter/pose_clone).
using CloneCovariance = Eigen::Matrix<double, ErrorIndex::kSize, 6>;
struct PoseClone {
  Pose T_odom_imu;
  Matrix6d covariance = Matrix6d::Zero();             // rows attitude, position
  CloneCovariance cross = CloneCovariance::Zero();    // E[state's error * clone's error^T]
};

/// All that propagation needs to go on from one instant: what the estimator hands to the predictor.
struct FilterSnapshot {
  HostTime time;
  InertialState state;
  ErrorCovariance covariance = ErrorCovariance::Zero();
  Eigen::Vector3d angular_velocity_rads = Eigen::Vector3d::Zero();  // imu frame, bias-free; carried on through IMU gaps
  /// What the map itself has drifted since odom's origin, of base: rows as NavState::covariance. The filter's own
  /// covariance is relative to the map around the vehicle.
  Matrix6d map_covariance = Matrix6d::Zero();
  PoseClone clone;  // of the newest keyframe
};

}  // namespace slamd
