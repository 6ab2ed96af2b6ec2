#include "daemon/threads/estimator_thread.hpp"

#include <optional>

#include "daemon/server/host_clock.hpp"
#include "daemon/threads/pause.hpp"

namespace slamd {
namespace {

template <class T>
std::optional<HostTime> oldest_arrival(SpscRing<T>& ring) {
  const T* item = ring.front();
  return item != nullptr ? std::optional{item->arrival} : std::nullopt;
}

}  // namespace

EstimatorThread::EstimatorThread(const EstimatorThreadConfig& config, const VehicleGeometry& geometry,
                                 const OdometryConfig& odometry, Streams& streams)
    : config_{config}, merge_{config.merge}, odometry_{geometry, odometry}, streams_{streams}, keyframes_{streams.keyframes} {}

void EstimatorThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    passes_.fetch_add(1, std::memory_order_relaxed);
    if (take_event(host_now())) {
      take_scans();
    } else {
      pause_for(config_.poll_period);
    }
  }
}

bool EstimatorThread::take_event(HostTime now) SLAMD_NONBLOCKING {
  const NextEvent event =
      merge_.next({oldest_arrival(streams_.imu), oldest_arrival(streams_.lidar), oldest_arrival(streams_.gnss)}, now);
  late_events_.store(merge_.late(), std::memory_order_relaxed);
  if (event.kind != NextEvent::Kind::kNone) newest_event_ = event.time;
  switch (event.kind) {
    case NextEvent::Kind::kNone:
    case NextEvent::Kind::kWheel:  // no rings of theirs here
    case NextEvent::Kind::kLaser:
      return false;
    case NextEvent::Kind::kLidar:
      odometry_.add(*streams_.lidar.front());
      streams_.lidar.pop();
      break;
    case NextEvent::Kind::kImu:
      odometry_.add(*streams_.imu.front());
      streams_.imu.pop();
      break;
    case NextEvent::Kind::kGnss:
      streams_.fixes.try_push(*streams_.gnss.front());
      streams_.gnss.pop();
      break;
    case NextEvent::Kind::kSilence:
      odometry_.advance(event.time);
      break;
  }
  return true;
}

void EstimatorThread::take_scans() SLAMD_NONBLOCKING {
  for (;;) {
    const HostTime begin = host_now();
    const ScanResult* result = odometry_.step(share_of_next_scan());
    if (result == nullptr) return;
    const HostTime end = host_now();
    if (result->has_scan) {
      scan_time_.record(end - begin);
      scan_latency_.record(end - result->state.time);
    }
    publish(*result);
  }
}

/// Late, the estimator works on less until it has caught up: there is never a backlog, and the freshest scan wins.
double EstimatorThread::share_of_next_scan() {
  const std::optional<HostTime> end = odometry_.due();
  if (!end) return 1.0;
  const double share = scan_share(config_.budget, host_now() - newest_event_ - config_.merge.hold_back);
  if (share == 1.0) return share;
  (share > 0.0 ? thinned_scans_ : scans_let_go_).fetch_add(1, std::memory_order_relaxed);
  if (limited_ != nullptr) limited_->try_push({*end, share});
  return share;
}

void EstimatorThread::publish(const ScanResult& result) {
  Posterior& posterior = streams_.posterior.back();
  posterior.snapshot = result.snapshot;
  posterior.state = result.state;
  streams_.posterior.publish();
  if (result.state.status != TrackingStatus::kInitialising) {
    streams_.path.try_push({result.state.time, result.state.T_odom_base});
  }
  keyframes_.see(result);
  if (result.is_keyframe) keyframes_.offer(result, odometry_.keyframe_points());
  if (result.has_scan) scans_.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace slamd
