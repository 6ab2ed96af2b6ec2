#pragma once
// The outcome of ape or rpe as a table for the terminal and as JSON. Computes nothing.

#include <optional>
#include <string>
#include <vector>

#include "tools/slam-eval/metrics.hpp"

namespace slamd::eval {

struct ReportRow {
  PoseRelation relation;
  Statistics statistics;
};

struct Report {
  std::string metric;  // "ape" or "rpe"
  std::string truth_path;
  std::string estimate_path;
  std::string alignment;
  std::size_t matched_poses = 0;
  std::optional<RpeOptions> rpe;
  std::vector<ReportRow> rows;
};

/// One line a relation, one column a statistic.
std::string table(const Report& report);

/// {"metric", "truth", "estimate", "alignment", "matched_poses", "rpe": {..}, "results": {relation: {rmse, ..}}}.
/// Throws InputError when the file cannot be written.
void write_json(const Report& report, const std::string& path);

}  // namespace slamd::eval
