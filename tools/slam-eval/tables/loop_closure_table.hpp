#pragma once
// The paper's table of what its pose graph does to the error, and ours in the same form: the two as Markdown and JSON. Makes
// no run.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/slam-eval/tables/run_table.hpp"

namespace slamd::eval {

/// Front end alone, + loops, + GPS, + both; the first is what the others are compared with.
const std::vector<Configuration>& loop_closure_configurations();

/// Two Markdown tables, the paper's and ours, and below the errors of each run.
std::string loop_closure_markdown(const std::vector<Run>& runs);

/// {"paper": [...], "summary": [...], "runs": [...]}; metres, ratios to the run without the back end.
nlohmann::ordered_json loop_closure_json(const std::vector<Run>& runs);

}  // namespace slamd::eval
