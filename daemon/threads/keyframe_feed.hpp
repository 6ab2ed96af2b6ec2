#pragma once
// From the estimator to the mapping thread: fills the ring's slots with keyframes. Waits for nobody: a keyframe that finds
// the ring full is left out, and the next one says how it relates to the last that got through.

#include <atomic>
#include <cstdint>
#include <optional>

#include "daemon/ring/spsc_ring.hpp"
#include "estimator/odometry/lidar_inertial_odometry.hpp"

namespace slamd {

class KeyframeFeed {
 public:
  /// The slots' points must have the memory that they need. ring must outlive the feed.
  explicit KeyframeFeed(SpscRing<Keyframe>& ring) : ring_{ring} {}

  /// Every scan's result, before offer(). Biases that an IMU was given while scans contradicted it, or until kLearntAgain after, go
  /// into no keyframe, and so into no checkpoint: the last ones of before do.
  void see(const ScanResult& result);

  /// result  of a keyframe, points its own in base. Real time: no allocation; what a slot has no room for is left out.
  void offer(const ScanResult& result, const PointCloud& points);

  /// Any thread. Keyframes that got through; those left out are counted by the ring.
  std::uint64_t count() const { return count_.load(std::memory_order_relaxed); }

 private:
  static constexpr Duration kLearntAgain = std::chrono::seconds{60};

  Matrix6d since_last_kept(const ScanResult& result) const;

  SpscRing<Keyframe>& ring_;
  std::optional<HostTime> contradicted_;  // the newest scan that was
  Eigen::Vector3d gyro_bias_rads_ = Eigen::Vector3d::Zero();  // not doubted
  Eigen::Vector3d accel_bias_mps2_ = Eigen::Vector3d::Zero();
  Pose T_odom_left_out_;                             // base at the newest keyframe that was left out,
  Matrix6d left_out_covariance_ = Matrix6d::Zero();  // relative to the last that got through; zero: none was left out
  std::atomic<std::uint64_t> count_{0};
};

}  // namespace slamd
