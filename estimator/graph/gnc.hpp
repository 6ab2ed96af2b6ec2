#pragma once
// Least squares among edges of which some are plain wrong: graduated non-convexity with truncated least squares. It starts
// from the convex problem and sharpens; no edge is trusted or dropped before the rest had its say.
// Source: Yang, Antonante, Tzoumas, Carlone 2020, "Graduated Non-Convexity for Robust Spatial Perception", section IV-B.

#include <vector>

#include "estimator/graph/pose_graph.hpp"

namespace slamd {

struct GncConfig {
  double outlier_probability = 1e-4;  // of a right edge to be taken for wrong, when its information is true
  double sharpening = 1.4;            // of mu, a round; > 1
  int max_rounds = 100;
  int iterations_a_round = 2;
};

struct RobustOutcome {
  SolveOutcome solve;           // of the last round; objective without the edges that were dropped
  std::vector<double> weights;  // one an edge: 1 kept, 0 dropped; between them only when rounds ran out
  int rounds = 0;
};

/// Moves graph.poses from where they lie.
/// suspect  one an edge: true = may be wrong; the others always count fully
template <class Group>
RobustOutcome solve_robustly(PoseGraph<Group>& graph, const std::vector<bool>& suspect, const GncConfig& config,
                             const SolveLimits& limits);

/// The chi2 that a right edge of so many degrees of freedom exceeds with this probability (Wilson-Hilferty, 1 % exact).
double chi2_quantile(int degrees_of_freedom, double exceeding_probability);

}  // namespace slamd
