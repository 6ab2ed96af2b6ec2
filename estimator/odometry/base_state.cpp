#include "estimator/odometry/base_state.hpp"

namespace slamd {

using I = ErrorIndex;

Matrix6d local_covariance(const FilterSnapshot& snapshot, const Pose& T_base_imu) {
  // Position and attitude error of base from attitude and position error of the IMU, both right perturbations.
  Matrix6d J_base_imu = Matrix6d::Zero();
  J_base_imu.block<3, 3>(0, I::kAttitude) =
      -snapshot.state.R_odom_imu.toRotationMatrix() * skew(T_base_imu.inverse().translation);
  J_base_imu.block<3, 3>(0, I::kPosition) = Eigen::Matrix3d::Identity();
  J_base_imu.block<3, 3>(3, I::kAttitude) = T_base_imu.rotation.toRotationMatrix();
  return J_base_imu * snapshot.covariance.topLeftCorner<6, 6>() * J_base_imu.transpose();
}

NavState base_state(const FilterSnapshot& snapshot, const Pose& T_base_imu) {
  const InertialState& state = snapshot.state;
  const Pose T_imu_base = T_base_imu.inverse();
  const Eigen::Matrix3d R_odom_imu = state.R_odom_imu.toRotationMatrix();
  NavState out;
  out.time = snapshot.time;
  out.T_odom_base = state.T_odom_imu() * T_imu_base;
  out.velocity_mps = state.v_odom_imu + R_odom_imu * snapshot.angular_velocity_rads.cross(T_imu_base.translation);
  out.angular_velocity_rads = T_base_imu.rotation * snapshot.angular_velocity_rads;
  out.gyro_bias_rads = state.gyro_bias;
  out.accel_bias_mps2 = state.accel_bias;
  out.T_imu_lidar = state.T_imu_lidar;
  out.covariance = local_covariance(snapshot, T_base_imu) + snapshot.map_covariance;
  return out;
}

}  // namespace slamd
