#pragma once
// The front end's facade: IMU samples and LiDAR packets in, one NavState a scan and keyframes out. A pure function of its
// input events; no thread, clock, file or log. The 200 Hz pose between scans is odometry/pose_predictor.

#include <array>
#include <optional>

#include "estimator/filter/ieskf.hpp"
#include "estimator/filter/initialisation.hpp"
#include "estimator/lidar/deskew.hpp"
#include "estimator/lidar/scan_assembler.hpp"
#include "estimator/odometry/imu_buffer.hpp"
#include "estimator/types/keyframe.hpp"

namespace slamd {

struct OdometryConfig {
  ImuNoise imu_noise;
  InitialisationConfig initialisation;
  ScanAssemblerConfig scan;
  PlaneMapConfig map;
  PointToPlaneConfig point_to_plane;
  IeskfConfig update;
  std::uint32_t max_points = 4'000;           // segments that take part in one update
  double imu_deadline_s = 0.05;               // a scan waits so long for the IMU to cover it
  double imu_gap_s = 0.025;                   // more between two samples: the constant-velocity model fills in
  double lidar_timeout_s = 0.5;               // no scan for so long: DEGRADED no_lidar
  double lost_sigma_m = 5.0;                  // position sigma since the last fused scan beyond which we are LOST
  double coast_accel_mps2_rthz = 2.0;         // constant-velocity model: white acceleration
  double coast_gyro_rads_rthz = 0.5;          // and white rotation
  double keyframe_distance_m = 1.5;
  double keyframe_angle_rad = 0.1745;
};

/// What became of one scan.
struct ScanResult {
  NavState state;               // posterior at scan end
  UpdateSummary update;
  FilterSnapshot snapshot;      // for PosePredictor::correct
  bool is_keyframe = false;     // then keyframe_points() is this scan
};

class LidarInertialOdometry {
 public:
  LidarInertialOdometry(const VehicleGeometry& geometry, const OdometryConfig& config);

  /// Events in order of arrival. Samples or packets older than what was already used are counted and dropped.
  void add(const ImuSample& sample);
  void add(const LidarPacket& packet);
  /// Time has come to `now` without further events: deadlines pass, silent sensors are noticed.
  void advance(HostTime now);
  /// Fuses at most one finished scan that the IMU covers or whose deadline has passed. Null when there is none.
  const ScanResult* step();
  /// The de-skewed points of the newest keyframe, base frame at its scan's end. Valid until the next step().
  const PointCloud& keyframe_points() const { return keyframe_points_; }

 private:
  VehicleGeometry geometry_;
  OdometryConfig config_;
};

}  // namespace slamd
