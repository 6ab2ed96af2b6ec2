#pragma once
// What single edges cost a solved graph: those that are in it and those that are left out. Judges nothing; solves nothing.
// An edge's own error says little where nothing else holds a stretch: a wrong one bends it until its error is small, and a
// right one that is left out looks as bad as the drift that it would have taken away.

#include <cstddef>
#include <optional>
#include <vector>

#include "estimator/graph/pose_graph.hpp"

namespace slamd {

struct LoneEdge {
  std::size_t edge = 0;
  double adds = 0.0;
};

/// Of the kept suspects that no other kept edge confirms (loop_support) the one that adds most to the objective: by how much
/// that would fall without it, the rest solved anew (linearised). None where all are confirmed.
/// graph          its poses are the solution over the kept edges
/// kept, suspect  one an edge
template <class Group>
std::optional<LoneEdge> worst_lone_edge(const PoseGraph<Group>& graph, const std::vector<bool>& kept,
                                        const std::vector<bool>& suspect);

/// By how much the objective would rise with each of these edges that are not kept, one at a time (linearised). Empty when
/// there are none or the kept ones do not hold the graph.
template <class Group>
std::vector<double> costs_of_adding(const PoseGraph<Group>& graph, const std::vector<bool>& kept,
                                    const std::vector<std::size_t>& edges);

}  // namespace slamd
