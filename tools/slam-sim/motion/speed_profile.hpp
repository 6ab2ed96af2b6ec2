#pragma once
// Distance along a path over time within limits of speed, acceleration and curvature. Knows no height and no wobble.

#include "tools/slam-sim/motion/path.hpp"

namespace slamd::sim {

struct SpeedLimits {
  double speed_mps = 8.0;
  double acceleration_mps2 = 1.3;
  double braking_mps2 = 1.8;
  double lateral_mps2 = 2.2;
};

/// Drive from `from_m` to `to_m` along the path (to < from: in reverse), then rest for rest_s.
struct Leg {
  double from_m;
  double to_m;
  double rest_s;
};

struct SpeedPlan {
  SpeedLimits limits;
  double rest_at_start_s = 2.0;
  double speed_at_start_mps = 0.0;  // of the first leg
  std::vector<Leg> legs;            // each begins where the one before ended
};

/// Distance s at times 0, step_s, 2 step_s, ... until the last rest is over. Accelerations are smoothed over 0.8 s.
std::vector<double> distance_over_time(const Path& path, const SpeedPlan& plan, double step_s);

}  // namespace slamd::sim
