#pragma once
// Which scans become keyframes, and their points de-skewed into the base frame. Hands nothing on: the mapping thread's copy
// is the caller's affair.

#include <optional>

#include "estimator/lidar/deskew.hpp"
#include "estimator/types/point_cloud.hpp"

namespace slamd {

struct KeyframeConfig {
  double distance_m = 1.5;      // travel between two keyframes
  double angle_rad = 0.1745;    // or rotation
};

class KeyframePicker {
 public:
  KeyframePicker(const KeyframeConfig& config, std::size_t max_points);

  /// Whether the vehicle has moved on far enough since the last keyframe, or there was none.
  bool is_due(const Pose& T_odom_base) const;
  /// Makes the scan a keyframe. motion: finished, of this scan. No allocation.
  void take(const Scan& scan, const ScanMotion& motion, const Pose& T_base_lidar, const Pose& T_odom_base);
  /// odom has a new origin: the next scan is due.
  void forget() { T_odom_last_.reset(); }

  /// Of the newest keyframe, in base at its scan's end.
  const PointCloud& points() const { return points_; }

 private:
  KeyframeConfig config_;
  std::optional<Pose> T_odom_last_;  // base
  PointCloud points_;
};

}  // namespace slamd
