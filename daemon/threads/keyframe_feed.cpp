#include "daemon/threads/keyframe_feed.hpp"

#include <algorithm>
#include <cstddef>

#include "estimator/math/se3.hpp"

namespace slamd {

void KeyframeFeed::see(const ScanResult& result) {
  const NavState& state = result.state;
  if (result.imu_contradicted) contradicted_ = state.time;
  const bool doubted = contradicted_ && state.time - *contradicted_ < kLearntAgain;
  if (doubted || state.status == TrackingStatus::kInitialising) return;
  gyro_bias_rads_ = state.gyro_bias_rads;
  accel_bias_mps2_ = state.accel_bias_mps2;
}

void KeyframeFeed::offer(const ScanResult& result, const PointCloud& points) {
  const Matrix6d relative_covariance = since_last_kept(result);
  Keyframe* slot = ring_.claim();
  if (slot == nullptr) {
    T_odom_left_out_ = result.state.T_odom_base;
    left_out_covariance_ = relative_covariance;
    return;
  }
  left_out_covariance_.setZero();
  const std::size_t count = std::min(points.size(), slot->points.capacity());
  slot->id = count_.fetch_add(1, std::memory_order_relaxed);
  slot->state = result.state;
  slot->state.gyro_bias_rads = gyro_bias_rads_;
  slot->state.accel_bias_mps2 = accel_bias_mps2_;
  slot->relative_covariance = relative_covariance;
  slot->up_base = result.up.up_base;
  slot->up_sigma_rad = result.up.sigma_rad;
  slot->scan_span = result.scan_span;
  slot->points.assign(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count));
  ring_.commit();
}

/// Steps taken as independent: Exp(e) at the one left out is Exp(Ad e) at this one.
Matrix6d KeyframeFeed::since_last_kept(const ScanResult& result) const {
  const Matrix6d Ad_this_left_out = adjoint(result.state.T_odom_base.inverse() * T_odom_left_out_);
  return Ad_this_left_out * left_out_covariance_ * Ad_this_left_out.transpose() + result.relative_covariance;
}

}  // namespace slamd
