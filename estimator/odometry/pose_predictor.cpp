#include "estimator/odometry/pose_predictor.hpp"

#include "estimator/odometry/base_state.hpp"

namespace slamd {

PosePredictor::PosePredictor(const VehicleGeometry& geometry, const DeadReckoningConfig& dead_reckoning,
                             const ImuIntakeConfig& imu)
    : T_base_imu_{geometry.T_base_imu}, dead_reckoning_{dead_reckoning}, imu_{imu} {}

void PosePredictor::correct(const FilterSnapshot& snapshot, const NavState& posterior) {
  filter_ = snapshot;
  posterior_ = posterior;
  has_posterior_ = true;
}

NavState PosePredictor::add(const ImuSample& sample) {
  imu_.add(sample);
  return coast_to(std::min(sample.time, sample.arrival));
}

NavState PosePredictor::coast_to(HostTime time) {
  if (!has_posterior_) {
    NavState none;
    none.time = time;
    return none;
  }
  if (time > filter_.time) dead_reckoning_.advance(imu_.samples(), time, filter_, [](const FilterSnapshot&) {});
  return state();
}

NavState PosePredictor::state() const {
  NavState out = base_state(filter_, T_base_imu_);
  out.odom_piece = posterior_.odom_piece;
  out.status = posterior_.status;
  out.reasons = posterior_.reasons;
  out.degenerate_direction = posterior_.degenerate_direction;
  out.lidar_test_ratio = posterior_.lidar_test_ratio;
  if (!imu_.sanity().is_sane()) out.reasons |= bit(StatusReason::kNoImu);
  if (imu_.is_clock_unsure(out.time)) out.reasons |= bit(StatusReason::kClockUnsure);
  if (out.reasons != 0 && out.status == TrackingStatus::kTracking) out.status = TrackingStatus::kDegraded;
  return out;
}

}  // namespace slamd
