#pragma once
// The subcommands of slam-eval as CLI11 options and what they run. The mathematics is in slamd::eval.

#include <string>
#include <vector>

#include "tools/slam-eval/alignment.hpp"
#include "tools/slam-eval/association.hpp"
#include "tools/slam-eval/metrics.hpp"

namespace CLI {
class App;
}

namespace slamd::eval {

/// What ape and rpe have in common, as given on the command line.
struct CommonOptions {
  std::string truth_path;
  std::string estimate_path;
  std::string format = "auto";  // auto, tum, kitti
  AssociationOptions association;
  Alignment alignment = Alignment::kNone;
  std::size_t align_count = 0;  // poses used for the fit; 0 = all
  bool in_plane = false;        // x, y and heading count alone
  std::vector<PoseRelation> relations{PoseRelation::kTranslationPart, PoseRelation::kRotationAngleDeg,
                                      PoseRelation::kFullTransformation};
  std::string json_path;
  std::string plot_path;
};

/// Adds `ape`, `rpe`, `relations`, `picture` and `tables` to the program; parsing runs the chosen one. Their callbacks throw InputError.
void add_ape(CLI::App& app);
void add_rpe(CLI::App& app);
void add_relations(CLI::App& app);
void add_picture(CLI::App& app);
void add_tables(CLI::App& app);

}  // namespace slamd::eval
