#pragma once
// Which doubtful edges agree with the drive as far as it is known: a start for robust least squares that groups of wrong
// loops, which agree with each other, do not lead astray. Nothing is solved here.

#include <functional>
#include <vector>

#include "estimator/graph/pose_graph.hpp"

namespace slamd {

struct LoopConsensusConfig {
  double outlier_probability = 1e-3;  // of a right edge to be taken for wrong, when all covariances are true
  double noise_margin = 3.0;          // on the scale of errors that is found; right edges in its tails come in later
  double first_reach = 4.0;           // in steps of odometry: rings of so many are judged first
  double reach_growth = 1.5;
  double shorter_alone = 16.0;        // a suspect that no other confirms waits for a ring so many times shorter
};

/// One an edge: true for edges that are not suspect, and for suspects that fit the shortest way through the others. Rings
/// are judged from the shortest to the longest, and each edge that is believed shortens the ways that later ones are judged
/// by: so a wrong edge is met by a way that is surer than itself, where there is one at all. Suspects that many others confirm
/// come before lone ones. Suspects that join what nothing
/// else joins are not believed.
/// cancelled  ends it with what is believed so far; may be empty
/// Cost: a search from each suspect's end, over the ways that are shorter than its own, a few times.
template <class Group>
std::vector<bool> consenting_edges(const PoseGraph<Group>& graph, const std::vector<bool>& suspect,
                                   const LoopConsensusConfig& config = {}, const std::function<bool()>& cancelled = {});

}  // namespace slamd
