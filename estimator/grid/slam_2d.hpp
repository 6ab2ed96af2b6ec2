#pragma once
// Planar SLAM in one object and one thread: events in, poses, trajectory and occupancy grid out. With a thread of its own for
// the back end take PlanarOdometry and PlanarMapper apart; this is nothing but the two.

#include "estimator/grid/planar_mapper.hpp"
#include "estimator/grid/planar_odometry.hpp"

namespace slamd {

struct Slam2dConfig {
  PlanarOdometryConfig odometry;
  PlanarMapperConfig mapper;
};

/// A pure function of its events: the same ones, with the same calls of work() between them, give the same bits.
class Slam2d {
 public:
  Slam2d(const VehicleGeometry& vehicle, const Slam2dConfig& config)
      : odometry_{vehicle, config.odometry}, mapper_{config.mapper, config.odometry} {}

  /// Events in order of arrival. Any of them may be missing: wheels, IMU.
  void add(const WheelOdometry& wheels) { odometry_.add(wheels); }
  void add(const ImuSample& sample) { odometry_.add(sample); }
  /// A scan: its pose, or nullptr when it was not used. Valid until the next scan.
  const PlanarResult* add(const LaserScan& scan) { return keep(odometry_.add(scan)); }
  const PlanarResult* add(const Scan& scan) { return keep(odometry_.add(scan)); }

  /// See PlanarMapper::work().
  bool work() { return mapper_.work(); }
  /// The drive is over: all that is left to do, and a last solve.
  void finish() { mapper_.finish(); }

  /// map is odom without its drift, as far as loops told it.
  PlanarPose T_map_odom() const { return mapper_.T_map_odom(); }
  PlanarPose to_map(HostTime time, const PlanarPose& T_odom_base) const { return mapper_.to_map(time, T_odom_base); }
  OccupancyGrid grid() const { return mapper_.grid(); }
  const PlanarMapper& mapper() const { return mapper_; }
  const PlanarOdometry& odometry() const { return odometry_; }

 private:
  const PlanarResult* keep(const PlanarResult* result) {
    if (result != nullptr && result->is_keyframe) mapper_.add(odometry_.keyframe());
    return result;
  }

  PlanarOdometry odometry_;
  PlanarMapper mapper_;
};

}  // namespace slamd
