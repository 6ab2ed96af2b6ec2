#pragma once
// Status and reasons of a pose from the evidence of how it came about. Estimates nothing.

#include "estimator/filter/ieskf.hpp"
#include "estimator/types/nav_state.hpp"

namespace slamd {

struct StatusConfig {
  double max_test_ratio = 4.0;         // mean squared normalised residual beyond which scan and map disagree
  double usable_sigma_m = 0.5;         // position sigma relative to the local map beyond which the pose is DEGRADED
  double lost_sigma_m = 5.0;           // and beyond which it is LOST
};

/// All that a status depends on.
struct Evidence {
  bool has_scan = false;
  bool complete_scan = true;
  bool imu_is_alive = true;
  bool coasted = false;              // a part of the motion was not measured
  bool clipped = false;
  bool imu_contradicted = false;     // the scan's motion is another one than the IMU's
  bool clock_unsure = false;
  bool map_is_mature = false;        // seen from enough places to be contradicted by a scan
  bool map_restarted = false;
  bool velocity_unknown = false;     // a moving start still looks for it
  bool velocity_overdue = false;     // and has looked for too long
  std::uint32_t unfused_scans = 0;   // in a row
  double local_sigma_m = 0.0;        // of position relative to the map around: drift makes no pose useless
  UpdateSummary update;
};

struct Judgement {
  TrackingStatus status = TrackingStatus::kTracking;
  std::uint32_t reasons = 0;         // bits of StatusReason
  float lidar_test_ratio = 0.0F;     // as NavState's
};

Judgement judge(const StatusConfig& config, const Evidence& evidence);

}  // namespace slamd
