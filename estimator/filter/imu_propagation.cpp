#include "estimator/filter/imu_propagation.hpp"

namespace slamd {

using I = ErrorIndex;

namespace {

struct Midpoint {
  double dt;
  Eigen::Vector3d half_turn;       // rotation vector of half the interval
  Eigen::Matrix3d R_odom_mid;
  Eigen::Vector3d specific_force;  // bias-free, imu frame at mid-interval
};

Midpoint midpoint(const InertialState& state, const ImuInterval& interval) {
  const double dt = to_seconds(interval.length);
  const Eigen::Vector3d half = 0.5 * dt * (interval.gyro_rads - state.gyro_bias);
  return {dt, half, (state.R_odom_imu * exp_so3(half)).toRotationMatrix(), interval.accel_mps2 - state.accel_bias};
}

}  // namespace

InertialState propagate(const InertialState& state, const ImuInterval& interval) {
  const Midpoint m = midpoint(state, interval);
  const Eigen::Vector3d accel = m.R_odom_mid * m.specific_force + state.gravity;
  InertialState out = state;
  out.R_odom_imu = (state.R_odom_imu * exp_so3(2.0 * m.half_turn)).normalized();
  out.p_odom_imu += m.dt * (state.v_odom_imu + 0.5 * m.dt * accel);
  out.v_odom_imu += m.dt * accel;
  return out;
}

ErrorCovariance transition(const InertialState& state, const ImuInterval& interval) {
  const Midpoint m = midpoint(state, interval);
  const double dt = m.dt;
  const Eigen::Matrix3d half_jacobian = right_jacobian_so3(m.half_turn);
  // Attitude error at mid-interval: theta_mid = Exp(half)^T theta - J_r(half) dt/2 b_g.
  const Eigen::Matrix3d force_by_mid = -m.R_odom_mid * skew(m.specific_force);
  const Eigen::Matrix3d accel_by_attitude = force_by_mid * exp_so3(-m.half_turn).toRotationMatrix();
  const Eigen::Matrix3d accel_by_gyro_bias = force_by_mid * half_jacobian * (-0.5 * dt);
  const Matrix32d accel_by_gravity = -skew(state.gravity) * tangent_basis_s2(state.gravity);

  ErrorCovariance F = ErrorCovariance::Identity();
  F.block<3, 3>(I::kAttitude, I::kAttitude) = exp_so3(-2.0 * m.half_turn).toRotationMatrix();
  F.block<3, 3>(I::kAttitude, I::kGyroBias) = -dt * right_jacobian_so3(2.0 * m.half_turn);
  F.block<3, 3>(I::kPosition, I::kVelocity) = dt * Eigen::Matrix3d::Identity();
  const auto accel_into = [&](int row, double factor) {
    F.block<3, 3>(row, I::kAttitude) = factor * accel_by_attitude;
    F.block<3, 3>(row, I::kGyroBias) = factor * accel_by_gyro_bias;
    F.block<3, 3>(row, I::kAccelBias) = -factor * m.R_odom_mid;
    F.block<3, 2>(row, I::kGravity) = factor * accel_by_gravity;
  };
  accel_into(I::kVelocity, dt);
  accel_into(I::kPosition, 0.5 * dt * dt);
  return F;
}

namespace {

/// F P F^T + Q, where F differs from the identity in the rows of attitude, position and velocity only.
void carry(const ErrorCovariance& F, const ImuNoise& noise, double dt, ErrorCovariance& covariance) {
  const Eigen::Matrix<double, 6, I::kSize> pose_rows = F.topRows<6>() * covariance;
  const Eigen::Matrix<double, 3, I::kSize> velocity_rows = F.middleRows<3>(I::kVelocity) * covariance;
  covariance.topRows<6>() = pose_rows;
  covariance.middleRows<3>(I::kVelocity) = velocity_rows;
  const Eigen::Matrix<double, I::kSize, 6> pose_columns = covariance * F.topRows<6>().transpose();
  const Eigen::Matrix<double, I::kSize, 3> velocity_columns = covariance * F.middleRows<3>(I::kVelocity).transpose();
  covariance.leftCols<6>() = pose_columns;
  covariance.middleCols<3>(I::kVelocity) = velocity_columns;

  const auto add = [&](int index, double density, double factor) {
    covariance.diagonal().segment<3>(index).array() += density * density * factor;
  };
  add(I::kAttitude, noise.gyro_noise_rads_rthz, dt);
  add(I::kVelocity, noise.accel_noise_mps2_rthz, dt);
  add(I::kPosition, noise.accel_noise_mps2_rthz, dt * dt * dt / 3.0);
  add(I::kGyroBias, noise.gyro_bias_walk_rads2_rthz, dt);
  add(I::kAccelBias, noise.accel_bias_walk_mps3_rthz, dt);
  symmetrise(covariance);
}

}  // namespace

void propagate_covariance(const InertialState& state, const ImuInterval& interval, const ImuNoise& noise,
                          ErrorCovariance& covariance) {
  carry(transition(state, interval), noise, to_seconds(interval.length), covariance);
}

void coast_covariance(const ImuInterval& interval, const ImuNoise& noise, ErrorCovariance& covariance) {
  const double dt = to_seconds(interval.length);
  ErrorCovariance F = ErrorCovariance::Identity();
  F.block<3, 3>(I::kAttitude, I::kAttitude) = exp_so3(-dt * interval.gyro_rads).toRotationMatrix();
  F.block<3, 3>(I::kPosition, I::kVelocity) = dt * Eigen::Matrix3d::Identity();
  carry(F, noise, dt, covariance);
}

}  // namespace slamd
