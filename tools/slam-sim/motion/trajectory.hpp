#pragma once
// The true motion of the vehicle: one smooth curve of pose over time with exact derivatives. Sensors only read it.

#include "estimator/types/pose.hpp"
#include "tools/slam-sim/motion/speed_profile.hpp"

namespace slamd::sim {

/// base in world; velocities and accelerations of the base origin in world axes, rates in base axes. SI, radians.
struct Motion {
  Pose T_world_base;
  Eigen::Vector3d velocity, acceleration;
  Eigen::Vector3d rate, rate_change;
};

/// Standard deviations of the suspension's movement at full speed, and its reaction to acceleration.
struct Wobble {
  double heave_m = 0.010;
  double roll_rad = 0.006;
  double pitch_rad = 0.006;
  double yaw_rad = 0.0005;
  double wheel_hop = 0.02;  // share of fast (6-11 Hz) movement relative to the slow one
  double bumps_per_m = 0.0;
};

struct TrajectoryPlan {
  SpeedPlan speed;
  Wobble wobble;
  double slalom_m = 0.0;  // amplitude of swerving about the path
  std::uint64_t seed = 1;
};

class Trajectory {
 public:
  Trajectory(const World& world, const Path& path, const TrajectoryPlan& plan);

  /// Seconds from the start of the drive, 0..duration; the state is defined (at rest or running on) a little outside.
  Motion at(double t) const;
  Pose pose_at(double t) const;
  /// Distance travelled along the path, metres.
  double distance_at(double t) const { return distance_.at(t).value.x(); }
  double duration() const { return curve_.end(); }

 private:
  UniformSpline<6> curve_;  // x y z roll pitch yaw (unwrapped)
  UniformSpline<1> distance_;
};

}  // namespace slamd::sim
