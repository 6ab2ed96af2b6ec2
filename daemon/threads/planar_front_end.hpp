#pragma once
// The front end in the plane: scans, wheels and IMU through planar odometry, keyframes to the planar mapping thread. Bounded
// work, but unlike the one in space it allocates.

#include <optional>

#include "daemon/threads/front_end.hpp"
#include "daemon/threads/streams.hpp"
#include "estimator/grid/planar_odometry.hpp"
#include "estimator/lidar/scan_assembler.hpp"
#include "estimator/odometry/pose_predictor.hpp"

namespace slamd {

struct PlanarFrontEndConfig {
  PlanarOdometryConfig odometry;
  ScanAssemblerConfig assembler;  // of a LiDAR that spins
  DeadReckoningConfig dead_reckoning;
  ImuIntakeConfig imu;
  Duration lidar_silence = std::chrono::milliseconds{500};  // without a scan for so long the pose is DEGRADED; LOST after odometry.lost_s
};

class PlanarFrontEnd : public FrontEnd {
 public:
  /// streams must outlive it.
  PlanarFrontEnd(const PlanarFrontEndConfig& config, const VehicleGeometry& vehicle, Streams& streams);

  void add(const LidarPacket& packet) override;
  void add(const LaserScan& scan) override;
  void add(const ImuSample& sample) override;
  void add(const WheelOdometry& wheels) override { odometry_.add(wheels); }
  void advance(HostTime until) override { carry_on(until); }
  /// A scan is worked on as soon as it is whole: nothing is due later.
  void take_scans(HostTime) override {}

 private:
  template <class AnyScan>
  void fuse(const AnyScan& scan);
  void publish(const NavState& state);
  void offer_keyframe();
  void carry_on(HostTime now);

  PlanarFrontEndConfig config_;
  VehicleGeometry vehicle_;
  Streams& streams_;
  ScanAssembler assembler_;
  Scan scan_;
  PlanarOdometry odometry_;
  PosePredictor predictor_;              // of times without scans
  std::optional<NavState> newest_;       // that a scan told
  HostTime told_;                        // of the newest pose that no scan told
  Eigen::Matrix3d left_out_ = Eigen::Matrix3d::Zero();  // covariance of keyframes that found the ring full
};

/// All that propagation needs to go on from a state of the plane. velocity_sigma_mps: of each axis
FilterSnapshot snapshot_of(const NavState& state, const VehicleGeometry& vehicle, double velocity_sigma_mps);

}  // namespace slamd
