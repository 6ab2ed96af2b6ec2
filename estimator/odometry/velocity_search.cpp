#include "estimator/odometry/velocity_search.hpp"

namespace slamd {

using I = ErrorIndex;

namespace {

/// The three states at `row` known to sigma, and of nothing else.
void set_sigma(ErrorCovariance& p, int row, double sigma) {
  p.middleRows<3>(row).setZero();
  p.middleCols<3>(row).setZero();
  p.diagonal().segment<3>(row).setConstant(sigma * sigma);
}

}  // namespace

void VelocitySearch::begin(const InitialState& initial) {
  initial_ = initial.filter;
  settles_ = initial.with_imu;
  motion_known_ = initial.motion_known;
  is_on_ = true;
  unknown_ = config_.scans;
  rounds_ = 0;
  begin_round();
}

bool VelocitySearch::fused(const UpdateSummary& update, FilterSnapshot& filter) {
  if (unknown_ > 0) {
    --unknown_;
    keep_velocity(update, filter);
    is_on_ = unknown_ > 0 || settles_;
    return true;
  }
  count(update);
  if (round_.scans < config_.round_scans) return false;
  ++rounds_;
  is_on_ = !has_settled();
  if (is_on_) doubt(filter);
  begin_round();
  return true;
}

/// What skewed scans teach of biases and gravity is not kept; velocity stays unknown along the direction that the scan
/// leaves free.
void VelocitySearch::keep_velocity(const UpdateSummary& update, FilterSnapshot& filter) const {
  filter.state.gyro_bias = initial_.state.gyro_bias;
  filter.state.accel_bias = initial_.state.accel_bias;
  filter.state.gravity = initial_.state.gravity;
  filter.covariance = initial_.covariance;
  const double sigma_mps = motion_known_ ? config_.round_sigma_mps : config_.found_sigma_mps;
  const double found = sigma_mps * sigma_mps;
  auto velocity = filter.covariance.block<3, 3>(I::kVelocity, I::kVelocity);
  const double unknown = velocity.diagonal().maxCoeff();
  if (update.free_translations > 1) return;
  velocity = found * Eigen::Matrix3d::Identity();
  if (update.free_translations == 1) {
    velocity += (unknown - found) * update.free_direction * update.free_direction.transpose();
  }
}

void VelocitySearch::count(const UpdateSummary& update) {
  if (round_.scans >= config_.round_scans / 2) round_.late_test_ratio += update.test_ratio;
  round_.corrected_mps += update.corrected_mps;
  ++round_.scans;
}

/// What a round corrected as a whole is the difference between its begin, carried on by the IMU, and its end: two answers to
/// the same question, and neither the filter's own opinion of itself.
bool VelocitySearch::has_settled() const {
  const double late = config_.round_scans - config_.round_scans / 2;
  return (motion_known_ || rounds_ >= config_.least_rounds) && round_.corrected_mps.norm() < config_.settled_mps &&
         round_.late_test_ratio < config_.settled_test_ratio * late;
}

/// An unsettled round was sure of biases, gravity and velocity that its own skew had bent.
void VelocitySearch::doubt(FilterSnapshot& filter) const {
  filter.covariance = initial_.covariance;
  set_sigma(filter.covariance, I::kVelocity, config_.round_sigma_mps);
  set_sigma(filter.covariance, I::kGyroBias, config_.round_gyro_bias_rads);
}

}  // namespace slamd
