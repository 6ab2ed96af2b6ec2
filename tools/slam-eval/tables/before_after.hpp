#pragma once
// The picture of one drive before and after the back end: trajectories coloured by error on one scale, errors over the way.

#include <string>
#include <vector>

#include "tools/slam-eval/association.hpp"

namespace slamd::eval {

struct LabelledPath {
  std::string label;
  MatchedPoses poses;
};

/// Draws the first and the last path, and the errors (SE(3)-aligned) of all. At least one path. Writes a PNG of
/// 2400x760; throws plot::PlotError when that fails, InputError when a path cannot be aligned.
void write_before_after(const std::string& title, const std::vector<LabelledPath>& paths, const std::string& png_path);

}  // namespace slamd::eval
