#pragma once
// The estimator's thread: takes the sensors' events in order of arrival to the front end, in space or in the plane. Real
// time: it owns no device, writes no file and waits only for its next look at the rings.

#include <atomic>
#include <cstdint>
#include <memory>
#include <stop_token>

#include "daemon/ring/nonblocking.hpp"
#include "daemon/threads/event_merge.hpp"
#include "daemon/threads/front_end.hpp"
#include "daemon/threads/streams.hpp"

namespace slamd {

struct EstimatorThreadConfig {
  EventMergeConfig merge;
  Duration poll_period = std::chrono::milliseconds{1};  // between two looks at empty rings
  ScanBudgetConfig budget;
};

class EstimatorThread {
 public:
  /// streams must outlive it.
  EstimatorThread(const EstimatorThreadConfig& config, std::unique_ptr<FrontEnd> front_end, Streams& streams);

  /// Writes down the scans that get less than all points. Before run(); the ring must outlive it.
  void record_to(SpscRing<LimitedScan>& ring) { front_end_->record_to(ring); }

  /// The thread's body: returns soon after a stop request.
  void run(const std::stop_token& stop);

  /// Any thread.
  /// Looks at the rings: grows a thousand times a second while the thread works, food for a watchdog.
  std::uint64_t passes() const { return passes_.load(std::memory_order_relaxed); }
  /// Events out of order of arrival; with none, a replay of the recorded bytes gives the same bits.
  std::uint64_t late_events() const { return late_events_.load(std::memory_order_relaxed); }
  std::uint64_t scans() const { return front_end_->counts().scans.load(std::memory_order_relaxed); }
  std::uint64_t keyframes() const { return front_end_->counts().keyframes.load(std::memory_order_relaxed); }
  /// Scans for which there was no time: fused with a share of their points, and not at all.
  std::uint64_t thinned_scans() const { return front_end_->counts().thinned_scans.load(std::memory_order_relaxed); }
  std::uint64_t scans_let_go() const { return front_end_->counts().scans_let_go.load(std::memory_order_relaxed); }
  const Histogram& scan_time() const { return front_end_->counts().scan_time; }        // one step of the odometry
  const Histogram& scan_latency() const { return front_end_->counts().scan_latency; }  // end of the scan to its posterior

 private:
  bool take_event(HostTime now) SLAMD_NONBLOCKING;

  const EstimatorThreadConfig config_;
  EventMerge merge_;
  std::unique_ptr<FrontEnd> front_end_;
  Streams& streams_;
  std::atomic<std::uint64_t> passes_{0};
  std::atomic<std::uint64_t> late_events_{0};
  HostTime newest_event_;  // arrival
};

}  // namespace slamd
