#pragma once
// Least squares among edges of which some are plain wrong: a start from edges that agree with the drive
// (loop_consensus), then graduated non-convexity with truncated least squares over all. Works on whole files; the live graph has map_graph.
// Source: Yang, Antonante, Tzoumas, Carlone 2020, "Graduated Non-Convexity for Robust Spatial Perception", section IV-B.

#include <vector>

#include "estimator/graph/pose_graph.hpp"

namespace slamd {

struct GncConfig {
  double outlier_probability = 1e-4;  // of a right edge to be taken for wrong, when its information is true
  double noise_margin = 8.0;          // on the scale of errors that is found: tails of real files are heavy
  double least_margin = 1.5;          // where they are not
  double information_margin = 2.0;    // on what the file's own information promises, at most
  double first_sharpness = 0.03;      // mu: edges up to 1 / mu times the limit have a say at first
  double sharpening = 1.4;            // of mu, a round; > 1
  double second_chance = 100.0;       // in the end edges up to so many times the limit are tried once more
  int last_rounds = 10;               // until the kept set agrees with its own solution
  int max_rounds = 200;
  int iterations_a_round = 2;
};

struct RobustOutcome {
  SolveOutcome solve;           // of the last round; objective without the edges that were dropped
  std::vector<double> weights;  // one an edge: 1 kept, 0 dropped; between them only when rounds ran out
  int rounds = 0;
};

/// Moves graph.poses that are not fixed; uses no initial guess. Without a chordal start (anchor_parts) the weights are empty.
/// suspect  one an edge: true = may be wrong; the others always count fully
template <class Group>
RobustOutcome solve_robustly(PoseGraph<Group>& graph, const std::vector<bool>& suspect, const GncConfig& config,
                             const SolveLimits& limits);

/// The chi2 that a right edge of so many degrees of freedom exceeds with this probability (Wilson-Hilferty, 1 % exact).
double chi2_quantile(int degrees_of_freedom, double exceeding_probability);

}  // namespace slamd
