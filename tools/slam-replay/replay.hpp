#pragma once
// One recorded drive through the estimator, as fast as possible. The same code as the daemon's threads run, in one thread.

#include <vector>

#include "daemon/store/map_store.hpp"
#include "daemon/store/trajectory_store.hpp"
#include "estimator/graph/relocaliser.hpp"
#include "estimator/odometry/lidar_inertial_odometry.hpp"
#include "estimator/odometry/pose_predictor.hpp"
#include "tools/progress/progress.hpp"
#include "tools/slam-replay/drive/drive.hpp"
#include "tools/slam-replay/output.hpp"
#include "tools/slam-replay/report.hpp"

namespace slamd::replay {

class Replay {
 public:
  Replay(const VehicleGeometry& vehicle, const OdometryConfig& odometry, const MapStoreConfig& map, Relocaliser relocaliser);

  /// Runs the whole drive, the back end to its last optimisation. Without the map there is no back end either, and the
  /// memory is the front end's alone.
  void run(Drive& drive, Output& output, Progress& progress, bool with_map);

  const Report& report() const { return report_; }
  const StageTimes& times() const { return times_; }
  OdometryStats stats() const { return odometry_.stats(); }
  const MapStore& map() const { return map_; }
  const Mapper& mapper() const { return relocaliser_.mapper(); }
  /// One pose a scan in the back end's own odom, of those that have a place in the map; none without the map.
  std::vector<StampedPose> path() const;

 private:
  bool take(const Event& event, Output& output);
  void step(const Drive& drive, Output& output);
  void keep(const ScanResult& result, Output& output);
  void keep_keyframe(const ScanResult& result, Output& output);
  void finish_map();

  LidarInertialOdometry odometry_;
  PosePredictor predictor_;
  Relocaliser relocaliser_;
  MapStore map_;
  std::vector<NavState> path_;  // one a scan
  StageTimes times_;
  Report report_;
  HostTime first_, last_;
  Keyframe keyframe_;  // the newest
  bool with_map_ = true;
};

}  // namespace slamd::replay
