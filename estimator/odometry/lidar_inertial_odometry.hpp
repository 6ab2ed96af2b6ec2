#pragma once
// The front end's facade: IMU samples and LiDAR packets in, one NavState a scan and keyframes out. A pure function of its
// input events; no thread, clock, file or log. The 200 Hz pose between scans is odometry/pose_predictor.

#include "estimator/odometry/keyframe_picker.hpp"
#include "estimator/odometry/scan_matcher.hpp"
#include "estimator/odometry/scan_queue.hpp"
#include "estimator/odometry/standstill.hpp"
#include "estimator/odometry/starter.hpp"
#include "estimator/odometry/status_judge.hpp"
#include "estimator/types/keyframe.hpp"

namespace slamd {

struct OdometryConfig {
  ImuIntakeConfig imu;
  ScanQueueConfig scans;
  StarterConfig start;
  DeadReckoningConfig dead_reckoning;
  ScanFusionConfig fusion;
  ImuDoubtConfig imu_doubt;
  StandstillConfig standstill;
  StatusConfig status;
  KeyframeConfig keyframes;
  /// No scan for so long: DEGRADED no_lidar, and ten poses a second by dead reckoning instead. They describe the instant
  /// from which on a scan might still come (ScanQueue::latency before now, some 0.15 s): a late scan must find the filter no
  /// later than its begin.
  double lidar_timeout_s = 0.5;
};

/// What became of one scan, or of the time in which none came.
struct ScanResult {
  NavState state;             // posterior at scan end
  FilterSnapshot snapshot;    // for PosePredictor::correct
  UpdateSummary update;
  bool imu_contradicted = false;  // fused without it, see imu_doubt
  bool has_scan = false;      // false: only time passed (no_lidar)
  bool is_keyframe = false;   // then keyframe_points() is of this scan, and so are
  Matrix6d relative_covariance = Matrix6d::Zero();  // see Keyframe
  UpDirection up;
  Duration scan_span{};
};

/// What came of the input, and what was not used, by cause.
struct OdometryStats {
  ImuIntakeStats imu;
  ScanQueueStats queue;
  ScanFusionStats fusion;
  std::uint64_t scans_late = 0;      // older than the filter when they came
  std::uint64_t scans_thinned = 0;   // fused with a share of their points
  std::uint64_t scans_let_go = 0;    // not even that
  std::uint64_t imu_contradicted = 0;  // scans fused without the IMU, because they tell another motion
  std::uint64_t standstills = 0;       // scans at which the vehicle was known to stand
  std::uint64_t resets = 0;          // odom begun anew: the state was no number any more, or lost
};

class LidarInertialOdometry {
 public:
  LidarInertialOdometry(const VehicleGeometry& geometry, const OdometryConfig& config);

  /// Events in order of arrival.
  void add(const ImuSample& sample);
  void add(const LidarPacket& packet);
  /// Time has come to `now` without further events: deadlines pass, silent sensors are noticed.
  void advance(HostTime now);
  /// End of the scan that step() would fuse now; nothing when there is none.
  std::optional<HostTime> due() const;
  /// Fuses at most one finished scan that the IMU covers or whose deadline has passed. Null when there is none. The result
  /// is valid until the next step(). No allocation after warm-up.
  /// share  of its points may be worked on, 0..1, for who has no time for more; 0: the scan is let go. An input like the
  ///        events: the same shares give the same bits.
  const ScanResult* step(double share = 1.0);
  /// The de-skewed points of the newest keyframe, base frame at its scan's end. Valid until the next step().
  const PointCloud& keyframe_points() const { return keyframes_.points(); }

  /// Hears of every stage from now on; must outlive the odometry. Null: nobody.
  void set_stage_listener(StageListener* listener) {
    listener_ = listener;
    matcher_.set_stage_listener(listener);
  }

  OdometryStats stats() const;
  const PlaneMap& map() const { return fusion_.map(); }

 private:
  const ScanResult* fuse(const Scan& scan);
  void fuse_standstill();
  bool start(const Scan& scan);
  bool is_clock_unsure(HostTime at) const;
  void pick_keyframe(const Scan& scan);
  bool has_lost_its_way(const Scan& scan) const;
  double local_sigma_m() const;
  const ScanResult* start_over(HostTime time);
  const ScanResult* not_yet(HostTime time, std::uint32_t reasons);
  bool is_silent() const;
  std::uint32_t odom_piece() const { return static_cast<std::uint32_t>(stats_.resets); }
  const ScanResult* pass_time();
  void conclude(const DeadReckoningSummary& carried, bool complete_scan);
  void finished(Stage stage) const { if (listener_ != nullptr) listener_->finished(stage); }

  VehicleGeometry geometry_;
  OdometryConfig config_;
  ImuIntake imu_;
  ScanQueue queue_;
  Starter starter_;
  ScanMatcher matcher_;
  ScanFusion fusion_;
  KeyframePicker keyframes_;
  FilterSnapshot filter_;
  FilterSnapshot trusted_;   // the newest one that no sample of a broken IMU can have touched
  HostTime now_;
  HostTime last_scan_;       // end of the newest one that was fused or began a map
  ScanResult result_;
  OdometryStats stats_;      // what the parts do not count themselves
  StageListener* listener_ = nullptr;
};

}  // namespace slamd
