#pragma once
// The front end in space: LiDAR and IMU through the filter, keyframes with points to the mapping thread. Real time. It has no
// use for wheels and 2D scans.

#include "daemon/threads/front_end.hpp"
#include "daemon/threads/keyframe_feed.hpp"
#include "daemon/threads/streams.hpp"
#include "estimator/odometry/lidar_inertial_odometry.hpp"

namespace slamd {

struct SpatialFrontEndConfig {
  ScanBudgetConfig budget;
  Duration hold_back{};  // of the merge: an event is never younger when it comes here
};

class SpatialFrontEnd : public FrontEnd {
 public:
  /// Takes all memory that the odometry needs. streams must outlive it.
  SpatialFrontEnd(const SpatialFrontEndConfig& config, const VehicleGeometry& vehicle, const OdometryConfig& odometry,
                  Streams& streams)
      : config_{config}, odometry_{vehicle, odometry}, streams_{streams}, keyframes_{streams.keyframes} {}

  void add(const LidarPacket& packet) override { odometry_.add(packet); }
  void add(const LaserScan&) override {}
  void add(const ImuSample& sample) override { odometry_.add(sample); }
  void add(const WheelOdometry&) override {}
  void advance(HostTime until) override { odometry_.advance(until); }
  void take_scans(HostTime newest_event) override;

 private:
  double share_of_next_scan(HostTime newest_event);
  void publish(const ScanResult& result);

  const SpatialFrontEndConfig config_;
  LidarInertialOdometry odometry_;
  Streams& streams_;
  KeyframeFeed keyframes_;
};

}  // namespace slamd
