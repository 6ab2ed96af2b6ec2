#pragma once
// A route as a smooth curve by arc length. Plan view; no time, no height.

#include "tools/slam-sim/motion/uniform_spline.hpp"
#include "tools/slam-sim/world/world.hpp"

namespace slamd::sim {

struct PathPoint {
  Eigen::Vector2d position;
  double yaw;              // of the tangent, -pi..pi
  double curvature_per_m;  // positive: bends left
};

class Path {
 public:
  /// laps > 1 repeats a closed route. Needs at least two points.
  explicit Path(const Route& route, int laps = 1);

  double length() const { return arc_.empty() ? 0.0 : arc_.back(); }
  /// s in metres from the start, clamped to 0..length.
  PathPoint at(double s) const;

 private:
  double parameter(double s) const;

  UniformSpline<2> curve_;
  double knot_step_;
  std::vector<double> arc_;  // arc length at parameter i * knot_step_
};

}  // namespace slamd::sim
