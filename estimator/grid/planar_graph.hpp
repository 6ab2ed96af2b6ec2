#pragma once
// Where keyframes and closures together put the drive: estimator/graph's SE(2) graph made of them. It finds no closures.

#include <vector>

#include "estimator/graph/minimise.hpp"
#include "estimator/grid/planar_node.hpp"

namespace slamd {

struct PlanarGraphConfig {
  double closure_phi = 7.8;          // chi2 of a closure from which on it counts less (95 % of 3 degrees of freedom)
  double closure_correlation = 4.0;  // neighbouring closures share so much of their maps that so many have one error
  double neighbours_m = 4.0;         // at both ends
};

/// Moves T_map_base of the nodes (the first one stays) and sets the closures' weights. Closures whose nodes are gone must not be
/// among them. All count fully at first, and the loss tightens: a right one at the end of a long drift begins with a large error.
SolveOutcome solve_planar_graph(PlanarNodes& nodes, std::vector<PlanarClosure>& closures, const PlanarGraphConfig& config,
                                const SolveLimits& limits);

}  // namespace slamd
