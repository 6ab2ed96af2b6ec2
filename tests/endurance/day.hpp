#pragma once
// Hours of wire bytes through all of slamd that is a pure function of them: drivers, merge, odometry, predictor, back end, map and
// trajectory, as the daemon's threads call them, in one thread and as fast as it goes. It judges nothing.

#include <cstdint>

#include "daemon/config/config.hpp"
#include "daemon/ring/spsc_ring.hpp"
#include "daemon/store/map_store.hpp"
#include "daemon/store/trajectory_store.hpp"
#include "daemon/threads/keyframe_feed.hpp"
#include "estimator/graph/relocaliser.hpp"
#include "estimator/odometry/lidar_inertial_odometry.hpp"
#include "estimator/odometry/pose_predictor.hpp"
#include "tools/slam-replay/drive/drive.hpp"

namespace slamd::endurance {

/// Totals since the start.
struct DayCounts {
  std::uint64_t scans = 0;
  std::uint64_t tracking = 0;  // of the scans
  std::uint64_t lost = 0;
  std::uint64_t keyframes = 0;
  std::uint64_t fixes = 0;
};

class Day {
 public:
  explicit Day(const Config& config);

  /// Takes the next event of the drive in; false when it is over.
  bool take(replay::Drive& drive);

  HostTime now() const { return now_; }
  const DayCounts& counts() const { return counts_; }
  OdometryStats odometry() const { return odometry_.stats(); }
  const Relocaliser& back_end() const { return back_end_; }
  MapCounts map() const { return map_.counts(); }
  /// Newest pose at the end of a scan, in odom and in map.
  const Pose& T_odom_base() const { return T_odom_base_; }
  Pose T_map_base() const { return back_end_.link().T_map_odom * T_odom_base_; }

 private:
  void step();
  void keep(const ScanResult& result);
  void map_keyframes();

  LidarInertialOdometry odometry_;
  PosePredictor predictor_;
  SpscRing<Keyframe> ring_;
  KeyframeFeed feed_;
  Relocaliser back_end_;
  MapStore map_;
  TrajectoryStore trajectory_;
  Pose T_odom_base_;
  HostTime now_;
  DayCounts counts_;
};

}  // namespace slamd::endurance
