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

ErrorCovariance coast_transition(Duration length, const Eigen::Vector3d& angular_velocity_rads) {
  const double dt = to_seconds(length);
  ErrorCovariance F = ErrorCovariance::Identity();
  F.block<3, 3>(I::kAttitude, I::kAttitude) = exp_so3(-dt * angular_velocity_rads).toRotationMatrix();
  F.block<3, 3>(I::kPosition, I::kVelocity) = dt * Eigen::Matrix3d::Identity();
  return F;
}

namespace {

/// White noise of the sensors, integrated over dt_s.
void add_noise(const ImuNoise& noise, double dt_s, ErrorCovariance& covariance) {
  const auto add = [&](int row, int column, double density, double factor) {
    covariance.block<3, 3>(row, column).diagonal().array() += density * density * factor;
  };
  const double accel = noise.accel_noise_mps2_rthz;
  add(I::kAttitude, I::kAttitude, noise.gyro_noise_rads_rthz, dt_s);
  add(I::kVelocity, I::kVelocity, accel, dt_s);
  add(I::kPosition, I::kVelocity, accel, dt_s * dt_s / 2.0);
  add(I::kVelocity, I::kPosition, accel, dt_s * dt_s / 2.0);
  add(I::kPosition, I::kPosition, accel, dt_s * dt_s * dt_s / 3.0);
  add(I::kGyroBias, I::kGyroBias, noise.gyro_bias_walk_rads2_rthz, dt_s);
  add(I::kAccelBias, I::kAccelBias, noise.accel_bias_walk_mps3_rthz, dt_s);
}

}  // namespace

void propagate_covariance(const ErrorCovariance& F, const ImuNoise& noise, double dt_s, ErrorCovariance& covariance) {
  const Eigen::Matrix<double, 6, I::kSize> pose_rows = F.topRows<6>() * covariance;
  const Eigen::Matrix<double, 3, I::kSize> velocity_rows = F.middleRows<3>(I::kVelocity) * covariance;
  covariance.topRows<6>() = pose_rows;
  covariance.middleRows<3>(I::kVelocity) = velocity_rows;
  const Eigen::Matrix<double, I::kSize, 6> pose_columns = covariance * F.topRows<6>().transpose();
  const Eigen::Matrix<double, I::kSize, 3> velocity_columns = covariance * F.middleRows<3>(I::kVelocity).transpose();
  covariance.leftCols<6>() = pose_columns;
  covariance.middleCols<3>(I::kVelocity) = velocity_columns;
  add_noise(noise, dt_s, covariance);
  symmetrise(covariance);
}

void propagate_cross(const ErrorCovariance& F, CloneCovariance& cross) {
  const Matrix6d pose_rows = F.topRows<6>() * cross;
  const Eigen::Matrix<double, 3, 6> velocity_rows = F.middleRows<3>(I::kVelocity) * cross;
  cross.topRows<6>() = pose_rows;
  cross.middleRows<3>(I::kVelocity) = velocity_rows;
}

}  // namespace slamd
