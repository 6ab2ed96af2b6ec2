#pragma once
// What the estimator's thread drives: one of the two ways to turn events into poses, in space or in the plane. It takes no event
// from a ring and owns no thread.

#include <atomic>
#include <cstdint>

#include "daemon/health/histogram.hpp"
#include "daemon/ring/spsc_ring.hpp"
#include "daemon/threads/scan_budget.hpp"
#include "estimator/types/imu_sample.hpp"
#include "estimator/types/laser_scan.hpp"
#include "estimator/types/lidar_packet.hpp"
#include "estimator/types/wheel_odometry.hpp"

namespace slamd {

/// Any thread may read.
struct FrontEndCounts {
  std::atomic<std::uint64_t> scans{0};
  std::atomic<std::uint64_t> keyframes{0};      // that got through to the mapping thread
  std::atomic<std::uint64_t> thinned_scans{0};  // fused with a share of their points for want of time,
  std::atomic<std::uint64_t> scans_let_go{0};   // and not at all
  Histogram scan_time;                          // one step of the odometry
  Histogram scan_latency;                       // end of the scan to its posterior
};

class FrontEnd {
 public:
  virtual ~FrontEnd() = default;

  /// Events in order of arrival; those that a front end has no use for are let go.
  virtual void add(const LidarPacket& packet) = 0;
  virtual void add(const LaserScan& scan) = 0;
  virtual void add(const ImuSample& sample) = 0;
  virtual void add(const WheelOdometry& wheels) = 0;
  /// Nothing came up to this instant.
  virtual void advance(HostTime until) = 0;
  /// Works on the scans that are due and hands on what came of them. newest_event: arrival of the newest one
  virtual void take_scans(HostTime newest_event) = 0;

  /// Writes down the scans that get less than all points. Before the first event; the ring must outlive this.
  void record_to(SpscRing<LimitedScan>& ring) { limited_ = &ring; }

  const FrontEndCounts& counts() const { return counts_; }

 protected:
  FrontEndCounts counts_;
  SpscRing<LimitedScan>* limited_ = nullptr;  // null: nobody records
};

}  // namespace slamd
