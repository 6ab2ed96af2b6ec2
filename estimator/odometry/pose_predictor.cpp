#include "estimator/odometry/pose_predictor.hpp"

#include "estimator/odometry/base_state.hpp"

namespace slamd {

PosePredictor::PosePredictor(const VehicleGeometry& geometry, const DeadReckoningConfig& config)
    : T_base_imu_{geometry.T_base_imu}, dead_reckoning_{config} {}

void PosePredictor::correct(const FilterSnapshot& snapshot, const NavState& posterior) {
  filter_ = snapshot;
  posterior_ = posterior;
  has_posterior_ = true;
}

NavState PosePredictor::add(const ImuSample& sample) {
  samples_.push(sample);
  return coast_to(sample.time);
}

NavState PosePredictor::coast_to(HostTime time) {
  if (!has_posterior_) {
    NavState none;
    none.time = time;
    return none;
  }
  if (time > filter_.time) dead_reckoning_.advance(samples_, time, filter_, [](const FilterSnapshot&) {});
  return state();
}

NavState PosePredictor::state() const {
  NavState out = base_state(filter_, T_base_imu_);
  out.status = posterior_.status;
  out.reasons = posterior_.reasons;
  out.degenerate_direction = posterior_.degenerate_direction;
  out.lidar_test_ratio = posterior_.lidar_test_ratio;
  return out;
}

}  // namespace slamd
