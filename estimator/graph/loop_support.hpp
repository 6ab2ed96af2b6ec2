#pragma once
// Which doubtful edges have a neighbour that says the same: two loops that join the same two stretches of the drive close a
// short ring with a few steps of odometry. Wrong loops stand alone or contradict; nothing is solved here.

#include <vector>

#include "estimator/graph/pose_graph.hpp"

namespace slamd {

struct LoopSupportConfig {
  std::size_t reach = 5;              // poses between the ends of two neighbours, at most
  double outlier_probability = 1e-2;  // of two right loops to be taken for contradicting
};

/// One an edge: how many suspects it belongs to that agree with each other from one to the next, itself among them: their
/// rings close within the sum of their covariances (frames of neighbouring poses taken as parallel). 1 for edges that are not
/// suspect. Odometry: edges that are not suspect, of poses i and i + 1. Cost: the suspects times their neighbours.
template <class Group>
std::vector<std::size_t> supporting_groups(const PoseGraph<Group>& graph, const std::vector<bool>& suspect,
                                           const LoopSupportConfig& config = {});

/// One an edge: true for edges that are not suspect, and for suspects that another one agrees with.
template <class Group>
std::vector<bool> supported_edges(const PoseGraph<Group>& graph, const std::vector<bool>& suspect);

}  // namespace slamd
