#pragma once
// A keyframe in the plane as the back end keeps it, and a loop that was found between two. Plain values.

#include <deque>

#include "estimator/grid/planar_scan.hpp"
#include "estimator/graph/group_se2.hpp"

namespace slamd {

struct PlanarNode {
  std::uint64_t id = 0;
  double way_m = 0.0;                // driven since the first one
  PlanarPose T_odom_base, T_map_base;
  Eigen::Matrix3d relative_covariance = Eigen::Matrix3d::Zero();  // as PlanarKeyframe's
  Eigen::Matrix3d match_covariance = Eigen::Matrix3d::Zero();
  double inlier_share = 1.0;
  PlanarScan scan;
};

/// In order of id, without gaps.
using PlanarNodes = std::deque<PlanarNode>;

/// T_true = T_from_to * Exp(e), covariance of e.
struct PlanarClosure {
  std::uint64_t from = 0, to = 0;  // ids, from < to
  PlanarPose T_from_to;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  double weight = 1.0;             // by the last solve: 0 = found wrong
};

}  // namespace slamd
