#pragma once
// The front end's facade: IMU samples and LiDAR packets in, one NavState a scan and keyframes out. A pure function of its
// input events; no thread, clock, file or log. The 200 Hz pose between scans is odometry/pose_predictor.

#include "estimator/filter/initialisation.hpp"
#include "estimator/lidar/scan_assembler.hpp"
#include "estimator/odometry/dead_reckoning.hpp"
#include "estimator/odometry/keyframe_relation.hpp"
#include "estimator/odometry/scan_registration.hpp"
#include "estimator/types/keyframe.hpp"

namespace slamd {

struct OdometryConfig {
  InitialisationConfig initialisation;
  ScanAssemblerConfig scan;
  DeadReckoningConfig dead_reckoning;
  ScanRegistrationConfig registration;
  MapDriftConfig map_drift;
  double imu_deadline_s = 0.05;        // a scan waits so long for the IMU to cover it
  double imu_timeout_s = 0.25;         // no sample for so long: DEGRADED no_imu
  double lidar_timeout_s = 0.5;        // no scan for so long: DEGRADED no_lidar
  double max_test_ratio = 4.0;         // mean squared normalised residual beyond which scan and map disagree
  double usable_sigma_m = 0.5;         // position sigma relative to the local map beyond which the pose is DEGRADED
  double lost_sigma_m = 5.0;           // and beyond which it is LOST
  std::uint32_t max_unfused_scans = 20;    // in a row, then a new local map is begun where we believe to be
  std::uint32_t moving_start_scans = 4;    // until velocity is known and the map is begun anew
  double found_velocity_sigma_mps = 0.7;   // and how well it is known then
  double keyframe_distance_m = 1.5;
  double keyframe_angle_rad = 0.1745;
};

/// What became of one scan, or of the time in which none came.
struct ScanResult {
  NavState state;             // posterior at scan end
  FilterSnapshot snapshot;    // for PosePredictor::correct
  UpdateSummary update;
  bool has_scan = false;      // false: only time passed (no_lidar)
  bool is_keyframe = false;   // then keyframe_points() is of this scan, and so are
  Matrix6d relative_covariance = Matrix6d::Zero();  // see Keyframe
  UpDirection up;
};

/// Input that was not used, by cause.
struct OdometryStats {
  std::uint64_t imu_rejected = 0;    // out of order or not finite
  std::uint64_t scans = 0;           // finished by the assembler
  std::uint64_t scans_fused = 0;
  std::uint64_t scans_unfused = 0;   // too few inliers or contradiction
  std::uint64_t scans_late = 0;      // older than the filter, or overtaken by the next one
  std::uint64_t map_restarts = 0;
  std::uint64_t resets = 0;          // the state was no number any more: initialised anew
};

class LidarInertialOdometry {
 public:
  LidarInertialOdometry(const VehicleGeometry& geometry, const OdometryConfig& config);

  /// Events in order of arrival.
  void add(const ImuSample& sample);
  void add(const LidarPacket& packet);
  /// Time has come to `now` without further events: deadlines pass, silent sensors are noticed.
  void advance(HostTime now);
  /// Fuses at most one finished scan that the IMU covers or whose deadline has passed. Null when there is none. The result
  /// is valid until the next step(). No allocation after warm-up.
  const ScanResult* step();
  /// The de-skewed points of the newest keyframe, base frame at its scan's end. Valid until the next step().
  const PointCloud& keyframe_points() const { return keyframe_points_; }

  /// Hears of every stage from now on; must outlive the odometry. Null: nobody.
  void set_stage_listener(StageListener* listener) { listener_ = listener; }

  const OdometryStats& stats() const { return stats_; }
  const PlaneMap& map() const { return registration_.map(); }

 private:
  bool imu_is_alive(HostTime at) const;
  bool is_due(const Scan& scan) const;
  bool initialise(const Scan& scan);
  const ScanResult* fuse();
  const ScanResult* pass_time();
  void carry_to(const Scan& scan);
  void absorb(const Scan& scan);
  void keep_velocity_only();
  void begin_map_here(bool defines_odom);
  const ScanResult* start_over();
  void estimate_rate(const InertialState& before, double elapsed_s);
  void judge();
  void collect_keyframe(const Scan& scan);
  void finished(Stage stage) const { if (listener_ != nullptr) listener_->finished(stage); }

  struct Progress {
    bool initialised = false;
    bool coasted = false;             // the newest scan's motion was not measured wholly
    bool clipped = false;
    bool complete_scan = true;
    std::uint32_t moving_start_left = 0;
    std::uint32_t unfused = 0;        // scans in a row
    std::uint64_t scans = 0;          // since the start or the last reset
    bool restarted = false;           // the newest scan began a new local map
  };

  VehicleGeometry geometry_;
  OdometryConfig config_;
  ImuBuffer samples_;
  ScanAssembler assembler_;
  Scan pending_;
  bool has_pending_ = false;
  Initialisation initialisation_;
  DeadReckoning dead_reckoning_;
  ScanRegistration registration_;
  FilterSnapshot filter_;
  FilterSnapshot initial_;
  Progress progress_;
  std::optional<Pose> last_keyframe_;  // T_odom_base
  KeyframeRelation relation_;
  HostTime now_;
  ScanResult result_;
  PointCloud keyframe_points_;
  OdometryStats stats_;
  StageListener* listener_ = nullptr;
};

}  // namespace slamd
