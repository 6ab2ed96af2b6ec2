#pragma once
// What a scan shows of the level plane of the vehicle, at one instant. Raw scans are laser_scan.hpp and scan.hpp of types.

#include <Eigen/Core>
#include <vector>

#include "estimator/types/time.hpp"

namespace slamd {

/// level: base's origin and heading, z against gravity.
struct PlanarScan {
  HostTime time;                                            // of which level is; the end of the scan
  std::vector<Eigen::Vector2f> points;                      // where rays ended, level frame, one a spacing, metres
  std::vector<Eigen::Vector2f> normals;                     // of the wall at each point, unit, to the LiDAR's side; zero: not seen
  Eigen::Vector2f origin = Eigen::Vector2f::Zero();         // the LiDAR, where rays begin
  float mean_range_m = 0.0F;                                // of the points, from the LiDAR: how wide the world is
};

}  // namespace slamd
