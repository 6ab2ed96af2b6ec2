#include "tools/slam-eval/program/report.hpp"

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tools/slam-eval/trajectory.hpp"

namespace slamd::eval {
namespace {

const char* word(DeltaUnit delta_unit) {
  switch (delta_unit) {
    case DeltaUnit::kFrames: return "frames";
    case DeltaUnit::kMetres: return "m";
    case DeltaUnit::kDegrees: return "deg";
  }
  return "";
}

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[512];
  std::snprintf(text, sizeof(text), pattern, values...);
  return text;
}

std::string title(const Report& r) {
  std::string text = r.metric == "ape" ? "APE" : "RPE";
  text += format("  %zu matched poses, alignment %s", r.matched_poses, r.alignment.c_str());
  if (r.rpe) {
    text += format(", delta %g %s, %s, %zu pairs", r.rpe->delta, word(r.rpe->unit),
                   r.rpe->all_pairs ? "all pairs" : "consecutive pairs", r.rows.front().statistics.count);
  }
  return text + "\n  truth     " + r.truth_path + "\n  estimate  " + r.estimate_path + "\n";
}

}  // namespace

std::string table(const Report& report) {
  std::string text = title(report) + format("  %-26s%11s%11s%11s%11s%11s%11s%13s\n", "", "rmse", "mean", "median",
                                            "std", "min", "max", "sse");
  for (const ReportRow& row : report.rows) {
    const Statistics& s = row.statistics;
    std::string label = name(row.relation);
    if (*unit(row.relation) != '\0') label += std::string(" [") + unit(row.relation) + "]";
    text += format("  %-26s%11.6f%11.6f%11.6f%11.6f%11.6f%11.6f%13.6f\n", label.c_str(), s.rmse, s.mean, s.median, s.std,
                   s.min, s.max, s.sse);
  }
  return text;
}

void write_json(const Report& report, const std::string& path) {
  nlohmann::ordered_json j{{"metric", report.metric},
                           {"truth", report.truth_path},
                           {"estimate", report.estimate_path},
                           {"alignment", report.alignment},
                           {"matched_poses", report.matched_poses}};
  if (report.rpe) {
    j["rpe"] = {{"delta", report.rpe->delta}, {"unit", word(report.rpe->unit)}, {"all_pairs", report.rpe->all_pairs}};
  }
  for (const ReportRow& row : report.rows) {
    const Statistics& s = row.statistics;
    j["results"][name(row.relation)] = {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median}, {"std", s.std},
                                        {"min", s.min},   {"max", s.max},   {"sse", s.sse},       {"count", s.count}};
  }
  std::ofstream out(path);
  out << j.dump(2) << '\n';
  if (!out.flush()) throw InputError(path + ": cannot be written");
}

}  // namespace slamd::eval
