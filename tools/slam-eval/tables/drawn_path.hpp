#pragma once
// A trajectory as the pictures of its own map have it: coloured by its error, the truth laid over it. Draws nothing.

#include <vector>

#include "tools/plot/trajectory_plot.hpp"
#include "tools/slam-eval/association.hpp"
#include "tools/slam-eval/metrics.hpp"

namespace slamd::eval {

struct DrawnPath {
  plot::ColouredPath path;          // values are errors in metres
  std::vector<plot::Point> truth;   // SE(3)-aligned to the estimate
  Statistics ape{};
};

/// The map is in the estimate's frame, so the truth is laid over the estimate. Throws InputError when it cannot be aligned.
DrawnPath path_by_error(const MatchedPoses& matched);

}  // namespace slamd::eval
