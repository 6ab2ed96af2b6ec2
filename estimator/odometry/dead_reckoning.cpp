#include "estimator/odometry/dead_reckoning.hpp"

namespace slamd {

namespace {

/// What an ideal IMU would measure if velocity and body rate stayed as they are.
void fill_constant_velocity(const FilterSnapshot& filter, ImuInterval& interval) {
  const InertialState& state = filter.state;
  interval.gyro_rads = filter.angular_velocity_rads + state.gyro_bias;
  const Eigen::Quaterniond R_odom_mid =
      state.R_odom_imu * exp_so3(0.5 * to_seconds(interval.length) * filter.angular_velocity_rads);
  interval.accel_mps2 = R_odom_mid.conjugate() * (-state.gravity) + state.accel_bias;
}

}  // namespace

void DeadReckoning::step(const ImuPiece& piece, FilterSnapshot& filter, DeadReckoningSummary& summary) const {
  ImuInterval interval{piece.to - piece.from, piece.gyro_rads, piece.accel_mps2};
  ImuNoise noise = config_.imu_noise;
  if (piece.measured) {
    filter.angular_velocity_rads = piece.gyro_rads - filter.state.gyro_bias;
    summary.measured_s += to_seconds(interval.length);
  } else {
    fill_constant_velocity(filter, interval);
    noise.accel_noise_mps2_rthz = config_.coast_accel_mps2_rthz;
    noise.gyro_noise_rads_rthz = config_.coast_gyro_rads_rthz;
    summary.coasted_s += to_seconds(interval.length);
  }
  if (piece.clipped) {
    noise.accel_noise_mps2_rthz = config_.clipped_accel_mps2_rthz;
    noise.gyro_noise_rads_rthz = config_.clipped_gyro_rads_rthz;
    summary.clipped = true;
  }
  const ErrorCovariance F = piece.measured ? transition(filter.state, interval)
                                           : coast_transition(interval.length, filter.angular_velocity_rads);
  propagate_covariance(F, noise, to_seconds(interval.length), filter.covariance);
  propagate_cross(F, filter.clone.cross);
  filter.state = propagate(filter.state, interval);
  filter.time = piece.to;
}

}  // namespace slamd
