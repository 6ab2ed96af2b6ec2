#pragma once
// One revolution (or sweep) of a LiDAR that measures in one plane. Not a 3D scan (scan.hpp), not yet de-skewed.

#include <vector>

#include "estimator/types/time.hpp"

namespace slamd {

struct LaserBeam {
  float angle_rad;  // lidar frame, counter-clockwise seen from above, 0 = its x axis
  float range_m;    // 0: nothing returned within range_max_m
  float time_s;     // own measurement, after LaserScan::time
};

struct LaserScan {
  HostTime time;     // of the first beam
  HostTime arrival;  // of the last one; orders the events
  float range_max_m = 0.0F;
  std::vector<LaserBeam> beams;  // in order of measurement
};

}  // namespace slamd
