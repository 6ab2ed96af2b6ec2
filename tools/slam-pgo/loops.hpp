#pragma once
// Which edges of a file are odometry and which are loops, by the order of the poses' ids. Judges no measurement.

#include <algorithm>
#include <vector>

#include "estimator/graph/pose_graph.hpp"

namespace slamd::pgo {

/// One an edge: false = odometry, the first edge between two poses that follow each other (poses are in order of their ids,
/// which may have gaps); true = a loop, all others, a second edge between neighbours among them.
template <class Group>
std::vector<bool> loops_of(const PoseGraph<Group>& graph) {
  std::vector<bool> has_odometry(graph.poses.size(), false);  // from a pose to the next
  std::vector<bool> loops;
  for (const Edge<Group>& edge : graph.edges) {
    const auto [first, second] = std::minmax(edge.from, edge.to);
    const bool odometry = second - first == 1 && !has_odometry[first];
    if (odometry) has_odometry[first] = true;
    loops.push_back(!odometry);
  }
  return loops;
}

}  // namespace slamd::pgo
