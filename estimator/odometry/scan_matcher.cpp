#include "estimator/odometry/scan_matcher.hpp"

namespace slamd {

ScanMatch ScanMatcher::match(const Scan& scan, const ImuBuffer& samples, bool clock_unsure, ScanFusion& fusion,
                             FilterSnapshot& filter) {
  const FilterSnapshot before = filter;
  ScanMatch match = match_by(&samples, scan, fusion, filter);
  if (clock_unsure) imu_believed_until_ = scan.end + from_seconds(config_.imu_doubt.after_clock_s);
  if (match.carried.coasted_s > 0.0) guess_forgiven_until_ = scan.end + from_seconds(config_.imu_doubt.after_gap_s);
  if (!fusion.velocity_search().is_on() && is_contradiction(scan.end, match)) {
    match = explain(match.update, before, {scan, samples}, fusion, filter);
  }
  if (match.update.fused) learn_rate(before, match, filter);
  return match;
}

/// Whether the scan just matched contradicts the IMU. Where a guessed motion left the filter a while ago, a scan that fits but moves
/// it shows what was wrong with the guess.
bool ScanMatcher::is_contradiction(HostTime at, const ScanMatch& match) const {
  const bool can_doubt =
      at > imu_believed_until_ && match.carried.coasted_s == 0.0 && match.update.matched >= config_.min_inliers;
  if (!can_doubt) return false;
  return at > guess_forgiven_until_ ? !is_explained(match.update) : !fits(match.update, config_.max_test_ratio);
}

bool ScanMatcher::is_explained(const UpdateSummary& update) const {
  return fits(update, config_.max_test_ratio) && !is_moved(config_.imu_doubt, update);
}

/// On the prior of an IMU with unknown biases, or without it, whichever first explains what the scan sees. What neither explains is
/// the scan's own fault, and the IMU is believed.
ScanMatch ScanMatcher::explain(const UpdateSummary& contradiction, const FilterSnapshot& before, const Input& input,
                               ScanFusion& fusion, FilterSnapshot& filter) const {
  FilterSnapshot doubted = before;
  doubt_biases(config_.imu_doubt, contradiction, doubted);
  doubted.angular_velocity_rads = turn_rads_;
  for (const ImuBuffer* samples : {&input.samples, static_cast<const ImuBuffer*>(nullptr)}) {
    filter = doubted;
    ScanMatch match = match_by(samples, input.scan, fusion, filter);
    match.imu_contradicted = true;
    const bool without_imu_it_fits =
        samples == nullptr && (fits(match.update, config_.max_test_ratio) ||
                               fits_far_better(config_.imu_doubt, match.update, contradiction.inliers));
    if (is_explained(match.update) || without_imu_it_fits) return match;
  }
  filter = before;
  return match_by(&input.samples, input.scan, fusion, filter);
}

ScanMatch ScanMatcher::match_by(const ImuBuffer* samples, const Scan& scan, ScanFusion& fusion, FilterSnapshot& filter) const {
  ScanMatch match;
  match.carried = carry_by(samples, scan, fusion.motion(), filter);
  if (listener_ != nullptr) listener_->finished(Stage::kPropagate);
  match.update = fusion.match(scan, match.carried.measured_s == 0.0, filter, listener_);
  return match;
}

/// Dead reckoning to the scan's end; the knots inside the scan go to the de-skewing.
DeadReckoningSummary ScanMatcher::carry_by(const ImuBuffer* samples, const Scan& scan, ScanMotion& motion,
                                           FilterSnapshot& filter) const {
  motion.clear();
  const auto nothing = [](const FilterSnapshot&) {};
  const auto add_knot = [&](const FilterSnapshot& at) { motion.add(to_seconds(at.time - scan.begin), at.state.T_odom_imu()); };
  const auto advance = [&](HostTime to, const auto& on_knot) {
    return samples != nullptr ? dead_reckoning_.advance(*samples, to, filter, on_knot)
                              : dead_reckoning_.coast(to, filter, on_knot);
  };
  DeadReckoningSummary carried;
  if (filter.time < scan.begin) carried = advance(scan.begin, nothing);
  add_knot(filter);
  return carried + advance(scan.end, add_knot);
}

/// Without gyro the body rate is what turned the vehicle from one posterior to the next.
void ScanMatcher::learn_rate(const FilterSnapshot& before, const ScanMatch& match, FilterSnapshot& filter) {
  const Eigen::Vector3d turn = log_so3(before.state.R_odom_imu.conjugate() * filter.state.R_odom_imu);
  turn_rads_ = turn / to_seconds(filter.time - before.time);
  if (match.carried.coasted_s > 0.0) filter.angular_velocity_rads = turn_rads_;
}

}  // namespace slamd
