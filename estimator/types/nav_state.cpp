#include "estimator/types/nav_state.hpp"

namespace slamd {

const char* name(TrackingStatus status) {
  switch (status) {
    case TrackingStatus::kInitialising: return "INITIALISING";
    case TrackingStatus::kTracking: return "TRACKING";
    case TrackingStatus::kDegraded: return "DEGRADED";
    case TrackingStatus::kLost: return "LOST";
  }
  return "?";
}

const char* name(StatusReason reason) {
  switch (reason) {
    case StatusReason::kNoImu: return "no_imu";
    case StatusReason::kNoLidar: return "no_lidar";
    case StatusReason::kImuGap: return "imu_gap";
    case StatusReason::kImuClipped: return "imu_clipped";
    case StatusReason::kDegenerateTranslation: return "degenerate_translation";
    case StatusReason::kDegenerateRotation: return "degenerate_rotation";
    case StatusReason::kFewInliers: return "few_inliers";
    case StatusReason::kInnovation: return "innovation";
    case StatusReason::kHighUncertainty: return "high_uncertainty";
    case StatusReason::kClockUnsure: return "clock_unsure";
    case StatusReason::kReset: return "reset";
    case StatusReason::kLidarIncomplete: return "lidar_incomplete";
    case StatusReason::kRelocalising: return "relocalising";
    case StatusReason::kImuContradicted: return "imu_contradicted";
  }
  return "?";
}

}  // namespace slamd
