#include "tools/slam-eval/tables/loop_closure_table.hpp"

#include <algorithm>
#include <array>

#include "tools/slam-eval/tables/table_text.hpp"

namespace slamd::eval {
namespace {

/// Table "Effect of GTSAM Loop Closure on Pose Error (E-sim)" of the paper.
struct PaperRow {
  const char* sensor;
  const char* configuration;
  double ape_rmse_m;
  double rpe_rmse_m;
  double ape_open_m;  // of the same sensor without the pose graph
  double rpe_open_m;
};

constexpr std::array<PaperRow, 4> kPaper{{{"Velodyne", "open loop", 0.615, 0.154, 0.615, 0.154},
                                          {"Velodyne", "+ GTSAM PGO", 0.460, 0.276, 0.615, 0.154},
                                          {"RoboSense", "open loop", 0.404, 0.152, 0.404, 0.152},
                                          {"RoboSense", "+ GTSAM PGO", 0.585, 0.297, 0.404, 0.152}}};

const std::string& label(const std::string& configuration) {
  const auto& all = loop_closure_configurations();
  return std::ranges::find(all, configuration, &Configuration::name)->label;
}

std::string paper_table() {
  std::string table = "| paper: sensor | configuration | APE RMSE m | RPE RMSE m | APE to open loop | RPE to open loop |\n"
                      "| --- | --- | --- | --- | --- | --- |\n";
  for (const PaperRow& row : kPaper) {
    table += format("| %s | %s | %.3f | %.3f | %.2f | %.2f |\n", row.sensor, row.configuration, row.ape_rmse_m,
                    row.rpe_rmse_m, row.ape_rmse_m / row.ape_open_m, row.rpe_rmse_m / row.rpe_open_m);
  }
  return table;
}

std::string our_table(const std::vector<Run>& runs) {
  std::string table = "| ours: drive | configuration | APE RMSE m | RPE RMSE m | APE to open loop | RPE to open loop | closures |\n"
                      "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const Summary& row : summarise(runs, loop_closure_configurations())) {
    table += format("| %s, %.0f m, %zu %s | %s | %s | %s | %s | %s | %.0f |\n", row.scenario.c_str(), row.driven_m,
                    row.runs, row.runs == 1 ? "seed" : "seeds", label(row.configuration).c_str(),
                    text(row.ape_m, "%.4f").c_str(), text(row.rpe_m, "%.5f").c_str(),
                    text(row.ape_ratio, "%.2f").c_str(), text(row.rpe_ratio, "%.3f").c_str(), row.closures.median);
  }
  return table;
}

std::string run_table(const std::vector<Run>& runs) {
  std::string table = "| drive | configuration | APE RMSE m | APE max m | RPE RMSE m | closures |\n"
                      "| --- | --- | --- | --- | --- | --- |\n";
  for (const Run& run : runs) {
    table += format("| %s | %s | %.4f | %.4f | %.5f | %llu |\n", run.drive.text().c_str(), label(run.configuration).c_str(),
                    run.ape.rmse, run.ape.max, run.rpe.rmse, static_cast<unsigned long long>(run.closures));
  }
  return table;
}

nlohmann::ordered_json json_of(const Statistics& s) {
  return {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median}, {"max", s.max}};
}

nlohmann::ordered_json json_of(const Spread& s) {
  return {{"least", s.least}, {"median", s.median}, {"most", s.most}};
}

nlohmann::ordered_json json_of(const Summary& row) {
  return {{"scenario", row.scenario},         {"configuration", row.configuration}, {"runs", row.runs},
          {"driven_m", row.driven_m},         {"ape_m", json_of(row.ape_m)},        {"rpe_m", json_of(row.rpe_m)},
          {"ape_ratio", json_of(row.ape_ratio)}, {"rpe_ratio", json_of(row.rpe_ratio)}, {"closures", json_of(row.closures)}};
}

nlohmann::ordered_json json_of(const Run& run) {
  return {{"scenario", run.drive.scenario}, {"seed", run.drive.seed},       {"configuration", run.configuration},
          {"driven_m", run.driven_m},       {"closures", run.closures},     {"ape_m", json_of(run.ape)},
          {"rpe_m", json_of(run.rpe)}};
}

}  // namespace

const std::vector<Configuration>& loop_closure_configurations() {
  static const std::vector<Configuration> kAll{
      {"front-end", "front end only", {"--no-gps", "--no-loops", "--no-map"}, "odom.tum"},
      {"loops", "+ loops", {"--no-gps"}, "map.tum"},
      {"gps", "+ GPS", {"--no-loops"}, "map.tum"},
      {"both", "+ both", {}, "map.tum"}};
  return kAll;
}

std::string loop_closure_markdown(const std::vector<Run>& runs) {
  return "# What the back end does to the error\n\n" + paper_table() + "\n" + our_table(runs) +
         "\nOurs: simulated drives; APE SE(3)-aligned, RPE over 1 m; least / median / most over the seeds; ratios are run by run to "
         "the same drive with the front end only.\n\n## Each run\n\n" +
         run_table(runs);
}

nlohmann::ordered_json loop_closure_json(const std::vector<Run>& runs) {
  nlohmann::ordered_json json{{"paper", nlohmann::json::array()},
                              {"summary", nlohmann::json::array()},
                              {"runs", nlohmann::json::array()}};
  for (const PaperRow& row : kPaper) {
    json["paper"].push_back({{"sensor", row.sensor}, {"configuration", row.configuration},
                             {"ape_rmse_m", row.ape_rmse_m}, {"rpe_rmse_m", row.rpe_rmse_m}});
  }
  for (const Summary& row : summarise(runs, loop_closure_configurations())) json["summary"].push_back(json_of(row));
  for (const Run& run : runs) json["runs"].push_back(json_of(run));
  return json;
}

}  // namespace slamd::eval
