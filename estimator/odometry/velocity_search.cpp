#include "estimator/odometry/velocity_search.hpp"

namespace slamd {

using I = ErrorIndex;

void VelocitySearch::begin(const InitialState& initial) {
  initial_ = initial.filter;
  settling_ = initial.with_imu ? config_.settling_scans : 0;
  left_ = config_.scans + settling_;
}

bool VelocitySearch::fused(const UpdateSummary& update, FilterSnapshot& filter) {
  --left_;
  const bool unknown = left_ >= settling_;
  if (unknown) keep_velocity(update, filter);
  return unknown || left_ == 0;
}

/// What skewed scans teach of biases and gravity is not kept; velocity stays unknown along the direction that the scan
/// leaves free.
void VelocitySearch::keep_velocity(const UpdateSummary& update, FilterSnapshot& filter) const {
  filter.state.gyro_bias = initial_.state.gyro_bias;
  filter.state.accel_bias = initial_.state.accel_bias;
  filter.state.gravity = initial_.state.gravity;
  filter.covariance = initial_.covariance;
  const double found = config_.found_sigma_mps * config_.found_sigma_mps;
  auto velocity = filter.covariance.block<3, 3>(I::kVelocity, I::kVelocity);
  const double unknown = velocity.diagonal().maxCoeff();
  if (update.free_translations > 1) return;
  velocity = found * Eigen::Matrix3d::Identity();
  if (update.free_translations == 1) {
    velocity += (unknown - found) * update.free_direction * update.free_direction.transpose();
  }
}

}  // namespace slamd
