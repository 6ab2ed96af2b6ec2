#pragma once
// The estimator's thread: takes the sensors' events in order of arrival, runs the odometry, hands on its results. Real
// time: it owns no device, writes no file and waits only for its next look at the rings.

#include <atomic>
#include <cstdint>
#include <stop_token>

#include "daemon/health/histogram.hpp"
#include "daemon/ring/nonblocking.hpp"
#include "daemon/threads/event_merge.hpp"
#include "daemon/threads/keyframe_feed.hpp"
#include "daemon/threads/scan_budget.hpp"
#include "daemon/threads/streams.hpp"
#include "estimator/odometry/lidar_inertial_odometry.hpp"

namespace slamd {

struct EstimatorThreadConfig {
  EventMergeConfig merge;
  Duration poll_period = std::chrono::milliseconds{1};  // between two looks at empty rings
  ScanBudgetConfig budget;
};

class EstimatorThread {
 public:
  /// Takes all memory that the odometry needs. streams must outlive it.
  EstimatorThread(const EstimatorThreadConfig& config, const VehicleGeometry& geometry, const OdometryConfig& odometry,
                  Streams& streams);

  /// Writes down the scans that get less than all points. Before run(); the ring must outlive it.
  void record_to(SpscRing<LimitedScan>& ring) { limited_ = &ring; }

  /// The thread's body: returns soon after a stop request.
  void run(const std::stop_token& stop);

  /// Any thread.
  /// Looks at the rings: grows a thousand times a second while the thread works, food for a watchdog.
  std::uint64_t passes() const { return passes_.load(std::memory_order_relaxed); }
  std::uint64_t scans() const { return scans_.load(std::memory_order_relaxed); }
  std::uint64_t keyframes() const { return keyframes_.count(); }
  /// Events out of order of arrival; with none, a replay of the recorded bytes gives the same bits.
  std::uint64_t late_events() const { return late_events_.load(std::memory_order_relaxed); }
  /// Scans for which there was no time: fused with a share of their points, and not at all.
  std::uint64_t thinned_scans() const { return thinned_scans_.load(std::memory_order_relaxed); }
  std::uint64_t scans_let_go() const { return scans_let_go_.load(std::memory_order_relaxed); }
  const Histogram& scan_time() const { return scan_time_; }        // one step of the odometry
  const Histogram& scan_latency() const { return scan_latency_; }  // end of the scan to its posterior

 private:
  bool take_event(HostTime now) SLAMD_NONBLOCKING;
  void take_scans() SLAMD_NONBLOCKING;
  double share_of_next_scan();
  void publish(const ScanResult& result);

  const EstimatorThreadConfig config_;
  EventMerge merge_;
  LidarInertialOdometry odometry_;
  Streams& streams_;
  KeyframeFeed keyframes_;
  Histogram scan_time_;
  Histogram scan_latency_;
  std::atomic<std::uint64_t> passes_{0};
  std::atomic<std::uint64_t> scans_{0};
  std::atomic<std::uint64_t> late_events_{0};
  std::atomic<std::uint64_t> thinned_scans_{0};
  std::atomic<std::uint64_t> scans_let_go_{0};
  HostTime newest_event_;  // arrival
  SpscRing<LimitedScan>* limited_ = nullptr;  // null: nobody records
};

}  // namespace slamd
