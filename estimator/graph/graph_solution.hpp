#pragma once
// What the back end publishes: where every keyframe, odom and ENU lie in map after a solve. A plain value that nobody
// changes once it is published; it computes nothing.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "estimator/types/pose.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

/// One keyframe as the front end measured it and as the graph believes it. Indexed by its id: ids have no gaps.
struct KeyframeEstimate {
  HostTime time;
  Pose T_odom_base;  // never changes
  Pose T_map_base;   // after the newest solve
};

/// Where ENU's own origin lies on the ellipsoid (WGS-84).
struct EnuOrigin {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double ellipsoid_height_m = 0.0;
};

using Matrix4d = Eigen::Matrix<double, 4, 4>;

/// Map in local East-North-Up: p_enu = Rz(yaw) * p_map + translation. Four degrees of freedom: gravity levels map.
struct EnuAlignment {
  double yaw_rad = 0.0;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // of map's origin in enu, metres
  /// Rows 0-2 translation (m, enu), row 3 yaw (rad).
  Matrix4d covariance = Matrix4d::Zero();

  Pose T_enu_map() const {
    return {Eigen::Quaterniond{Eigen::AngleAxisd{yaw_rad, Eigen::Vector3d::UnitZ()}}, translation};
  }
};

struct GraphSolution {
  Pose T_map_odom;
  bool enu_valid = false;  // false: enu and its origin say nothing
  EnuAlignment enu;
  EnuOrigin enu_origin;
  std::vector<KeyframeEstimate> keyframes;  // those that were there when it was solved
  std::uint64_t changes = 0;                // counts published solutions; 0: nothing was solved yet
  std::size_t closures = 0;                 // in the graph
  std::size_t positions = 0;                // GNSS positions in the graph
  double objective = 0.0;                   // sum of squared, whitened, robustly weighted errors
  int iterations = 0;
  bool converged = false;                   // false: cancelled or out of iterations; the next solve goes on from here
};

}  // namespace slamd
