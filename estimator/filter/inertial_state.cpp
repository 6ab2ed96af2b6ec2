#include "estimator/filter/inertial_state.hpp"

namespace slamd {

using I = ErrorIndex;

InertialState boxplus(const InertialState& state, const ErrorVector& error) {
  InertialState out = state;
  out.R_odom_imu = (state.R_odom_imu * exp_so3(error.segment<3>(I::kAttitude))).normalized();
  out.p_odom_imu += error.segment<3>(I::kPosition);
  out.T_imu_lidar.rotation =
      (state.T_imu_lidar.rotation * exp_so3(error.segment<3>(I::kExtrinsicRotation))).normalized();
  out.T_imu_lidar.translation += error.segment<3>(I::kExtrinsicTranslation);
  out.v_odom_imu += error.segment<3>(I::kVelocity);
  out.gyro_bias += error.segment<3>(I::kGyroBias);
  out.accel_bias += error.segment<3>(I::kAccelBias);
  out.gravity = boxplus_s2(state.gravity, error.segment<2>(I::kGravity));
  return out;
}

ErrorVector boxminus(const InertialState& to, const InertialState& from) {
  ErrorVector e;
  e.segment<3>(I::kAttitude) = log_so3(from.R_odom_imu.conjugate() * to.R_odom_imu);
  e.segment<3>(I::kPosition) = to.p_odom_imu - from.p_odom_imu;
  e.segment<3>(I::kExtrinsicRotation) = log_so3(from.T_imu_lidar.rotation.conjugate() * to.T_imu_lidar.rotation);
  e.segment<3>(I::kExtrinsicTranslation) = to.T_imu_lidar.translation - from.T_imu_lidar.translation;
  e.segment<3>(I::kVelocity) = to.v_odom_imu - from.v_odom_imu;
  e.segment<3>(I::kGyroBias) = to.gyro_bias - from.gyro_bias;
  e.segment<3>(I::kAccelBias) = to.accel_bias - from.accel_bias;
  e.segment<2>(I::kGravity) = boxminus_s2(to.gravity, from.gravity);
  return e;
}

ErrorCovariance boxminus_jacobian(const ErrorVector& e) {
  ErrorCovariance j = ErrorCovariance::Identity();
  j.block<3, 3>(I::kAttitude, I::kAttitude) = right_jacobian_inverse_so3(e.segment<3>(I::kAttitude));
  j.block<3, 3>(I::kExtrinsicRotation, I::kExtrinsicRotation) =
      right_jacobian_inverse_so3(e.segment<3>(I::kExtrinsicRotation));
  return j;
}

}  // namespace slamd
