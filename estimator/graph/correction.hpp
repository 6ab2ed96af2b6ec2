#pragma once
// Any pose of odom moved to map by a solution's keyframes. Knows only the solution: nothing is solved here.

#include "estimator/graph/graph_solution.hpp"

namespace slamd {

/// T_map_base of an instant. Between two keyframes the corrections of both are blended evenly over time, so that the path
/// has no steps; before the first and after the last the nearest one's holds. Cost: logarithmic in the keyframes.
Pose corrected_pose(const GraphSolution& solution, HostTime time, const Pose& T_odom_base);

}  // namespace slamd
