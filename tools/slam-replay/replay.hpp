#pragma once
// One recorded drive through the estimator, as fast as possible. The same code as the daemon's threads run, in one thread.

#include "daemon/store/map_store.hpp"
#include "estimator/odometry/lidar_inertial_odometry.hpp"
#include "estimator/odometry/pose_predictor.hpp"
#include "tools/progress/progress.hpp"
#include "tools/slam-replay/drive.hpp"
#include "tools/slam-replay/output.hpp"
#include "tools/slam-replay/report.hpp"

namespace slamd::replay {

class Replay {
 public:
  Replay(const VehicleGeometry& vehicle, const OdometryConfig& odometry, const MapStoreConfig& map);

  /// Runs the whole drive. Without the map its memory is the front end's alone.
  void run(Drive& drive, Output& output, Progress& progress, bool with_map);

  const Report& report() const { return report_; }
  const StageTimes& times() const { return times_; }
  OdometryStats stats() const { return odometry_.stats(); }
  const MapStore& map() const { return map_; }

 private:
  bool take(const Event& event, Output& output);
  void step(Output& output);
  void keep(const ScanResult& result, Output& output);

  LidarInertialOdometry odometry_;
  PosePredictor predictor_;
  MapStore map_;
  StageTimes times_;
  Report report_;
  HostTime first_, last_;
  Keyframe keyframe_;  // the newest
  bool with_map_ = true;
};

}  // namespace slamd::replay
