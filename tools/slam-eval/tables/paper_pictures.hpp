#pragma once
// The paper's figures of our runs: occupancy grids, maps from above, trajectories by error, before and after the pose graph.

#include <filesystem>
#include <string>
#include <vector>

#include "tools/slam-eval/tables/run_maker.hpp"

namespace slamd::eval {

struct Figure {
  std::string file;     // in the folder
  std::string caption;
};

/// Draws what the runs of these plans have left in options.work into `folder`. Throws plot::PlotError, plot::GridError, InputError.
std::vector<Figure> draw_figures(const RunMakerOptions& options, const std::vector<Plan>& plans, const std::filesystem::path& folder);

/// Captions with the pictures below them.
std::string figures_markdown(const std::vector<Figure>& figures);

}  // namespace slamd::eval
