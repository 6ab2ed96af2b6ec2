#pragma once
// Every table of the paper's results with ours beside it: which drives and runs they need, and the tables as Markdown and JSON. Makes
// no run.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/slam-eval/tables/run_table.hpp"

namespace slamd::eval {

/// APE and RPE, RMSE in metres; 0 where nothing is given.
struct ErrorPair {
  double ape_m = 0.0;
  double rpe_m = 0.0;
};

/// A line of a table.
struct PaperRow {
  std::string label;
  DriveName drive;            // of any seed
  Configuration configuration;
  ErrorPair paper;
  ErrorPair bar;              // at most
};

struct PaperTable {
  std::string title;          // the paper's caption
  std::vector<PaperRow> rows;
  bool to_gps = false;        // APE is to the GPS track, as the paper's own recordings have no other truth
};

/// In the paper's order: C1; sensors in 2D; loop closure; C1, C2 and C3; recorded cycles to GPS.
const std::vector<PaperTable>& paper_tables();

/// All that the tables need, each drive and run once. length_m  where every drive ends, 0 = whole
std::vector<Plan> paper_plans(const std::vector<std::uint64_t>& seeds, double length_m = 0.0);

/// The tables, and the front end's with mean, median, RMSE and greatest error.
std::string paper_markdown(const std::vector<Run>& runs);

/// {"tables": [{"title", "rows": [{"label", "paper", "bar", "runs"}]}]}; metres.
nlohmann::ordered_json paper_json(const std::vector<Run>& runs);

}  // namespace slamd::eval
