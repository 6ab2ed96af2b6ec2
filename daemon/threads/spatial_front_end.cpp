#include "daemon/threads/spatial_front_end.hpp"

#include <optional>

#include "daemon/server/host_clock.hpp"

namespace slamd {

void SpatialFrontEnd::take_scans(HostTime newest_event) {
  for (;;) {
    const HostTime begin = host_now();
    const ScanResult* result = odometry_.step(share_of_next_scan(newest_event));
    if (result == nullptr) return;
    const HostTime end = host_now();
    if (result->has_scan) {
      counts_.scan_time.record(end - begin);
      counts_.scan_latency.record(end - result->state.time);
    }
    publish(*result);
  }
}

/// Late, the estimator works on less until it has caught up: there is never a backlog, and the freshest scan wins.
double SpatialFrontEnd::share_of_next_scan(HostTime newest_event) {
  const std::optional<HostTime> end = odometry_.due();
  if (!end) return 1.0;
  const double share = scan_share(config_.budget, host_now() - newest_event - config_.hold_back);
  if (share == 1.0) return share;
  (share > 0.0 ? counts_.thinned_scans : counts_.scans_let_go).fetch_add(1, std::memory_order_relaxed);
  if (limited_ != nullptr) limited_->try_push({*end, share});
  return share;
}

void SpatialFrontEnd::publish(const ScanResult& result) {
  Posterior& posterior = streams_.posterior.back();
  posterior.snapshot = result.snapshot;
  posterior.state = result.state;
  streams_.posterior.publish();
  if (result.state.status != TrackingStatus::kInitialising) {
    streams_.path.try_push({result.state.time, result.state.T_odom_base});
  }
  keyframes_.see(result);
  if (result.is_keyframe) keyframes_.offer(result, odometry_.keyframe_points());
  counts_.keyframes.store(keyframes_.count(), std::memory_order_relaxed);
  if (result.has_scan) counts_.scans.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace slamd
