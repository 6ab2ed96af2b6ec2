#include "estimator/odometry/status_judge.hpp"

namespace slamd {

namespace {

std::uint32_t reasons_of(const StatusConfig& config, const Evidence& e) {
  std::uint32_t reasons = 0;
  const auto say = [&](bool holds, StatusReason reason) { reasons |= holds ? bit(reason) : 0U; };
  say(!e.imu_is_alive, StatusReason::kNoImu);
  say(e.coasted && e.imu_is_alive && !e.imu_contradicted, StatusReason::kImuGap);
  say(e.imu_contradicted, StatusReason::kImuContradicted);
  say(e.clipped, StatusReason::kImuClipped);
  say(e.clock_unsure, StatusReason::kClockUnsure);
  say(!e.has_scan, StatusReason::kNoLidar);
  say(e.has_scan && !e.complete_scan, StatusReason::kLidarIncomplete);
  say(e.update.free_translations > 0, StatusReason::kDegenerateTranslation);
  say(e.update.free_rotations > 0, StatusReason::kDegenerateRotation);
  say(e.unfused_scans > 0, StatusReason::kFewInliers);
  say(e.map_restarted, StatusReason::kReset);
  // Planes seen from few places flatter themselves: only a mature map can be contradicted.
  say(e.update.fused && e.map_is_mature && e.update.test_ratio > config.max_test_ratio, StatusReason::kInnovation);
  say(e.local_sigma_m > config.usable_sigma_m || e.velocity_overdue, StatusReason::kHighUncertainty);
  return reasons;
}

}  // namespace

Judgement judge(const StatusConfig& config, const Evidence& evidence) {
  Judgement out;
  out.reasons = reasons_of(config, evidence);
  out.lidar_test_ratio = static_cast<float>(evidence.update.test_ratio / config.max_test_ratio);
  if (out.reasons != 0) out.status = TrackingStatus::kDegraded;
  if (evidence.velocity_overdue || evidence.local_sigma_m > config.lost_sigma_m) out.status = TrackingStatus::kLost;
  if (evidence.velocity_unknown && !evidence.velocity_overdue) out.status = TrackingStatus::kInitialising;
  return out;
}

}  // namespace slamd
