#pragma once
// A map of planar mode as it outlives a process: keyframes where the map had them. Values alone; the file is daemon/store's.

#include <Eigen/Core>
#include <vector>

#include "estimator/types/time.hpp"

namespace slamd {

struct StoredPlanarKeyframe {
  HostTime time;                                      // of the clock of the process that stored it
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();     // T_map_base: x, y (m), yaw (rad)
  Eigen::Vector2f origin = Eigen::Vector2f::Zero();   // of the rays, level frame, metres
  std::vector<Eigen::Vector2f> points;                // where rays ended, level frame, metres
};

/// From the oldest on; empty: there is none.
using StoredPlanarMap = std::vector<StoredPlanarKeyframe>;

}  // namespace slamd
