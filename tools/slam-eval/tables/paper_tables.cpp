#include "tools/slam-eval/tables/paper_tables.hpp"

#include <algorithm>

#include "tools/slam-eval/tables/table_text.hpp"

namespace slamd::eval {
namespace {

// Drives. C1 and C2 have wheel odometry, as the paper's planar runs have.
DriveName house() { return {.scenario = "house"}; }
DriveName planar_campus(const std::string& lidar) {
  return {.scenario = "campus", .lidar = lidar, .options = {"--wheel"}, .variant = "wheel"};
}
DriveName campus(const std::string& lidar) { return {.scenario = "campus", .lidar = lidar}; }
DriveName grounds() { return {.scenario = "loop"}; }

Configuration planar() { return {"planar", "2D", {"--set", "mode=planar"}, "map.tum", true}; }
Configuration single_ring() {
  return {"single-ring", "2D, one ring", {"--set", "mode=planar", "--set", "planar.single_ring=true"}, "map.tum", true};
}
Configuration front_end() { return {"front-end", "open loop", {"--no-gps", "--no-loops", "--no-map"}, "odom.tum"}; }
Configuration loops() { return {"loops", "+ pose graph", {"--no-gps"}, "map.tum"}; }

/// Table "Pose Error for C3 FAST-LIO2 Front-End (E-sim)" of the paper.
constexpr Statistics kPaperFrontEndApe{.rmse = 0.615, .mean = 0.580, .median = 0.535, .max = 1.308};
constexpr Statistics kPaperFrontEndRpe{.rmse = 0.154, .mean = 0.108, .median = 0.067, .max = 0.551};

std::vector<PaperTable> make_tables() {
  const PaperRow c1{"C1: TurtleBot3, LDS-01", house(), planar(), {0.011, 0.012}, {0.010, 0.010}};
  const PaperRow ring{"C2: VLP-16, one ring", planar_campus("vlp16"), single_ring(), {0.027, 0.016}, {0.020, 0.012}};
  const PaperRow open{"VLP-16, open loop", campus("vlp16"), front_end(), {0.615, 0.154}, {0.030, 0.0}};
  const PaperRow closed{"VLP-16, + pose graph", campus("vlp16"), loops(), {0.460, 0.276}, {}};
  PaperRow c3 = open;
  c3.label = "C3: VLP-16 and IMU, 3D";
  PaperRow cycle_1 = ring, cycle_2{"C2, 560 m x 363 m", grounds(), planar(), {13.677, 0.096}, {1.0, 0.0}};
  cycle_1.label = "C2, campus";
  cycle_1.paper = {5.805, 0.206};
  cycle_1.bar = {};
  return {{"TurtleBot3 baseline (C1, E-sim)", {c1}},
          {"Comparison of LiDAR sensors in 2D (C2, E-sim)",
           {ring,
            {"VLP-16, level cut of all rings", planar_campus("vlp16"), planar(), {}, {}},
            {"RoboSense Airy, level cut", planar_campus("airy"), planar(), {0.089, 0.028}, {0.030, 0.015}},
            {"RPLidar A2", planar_campus("rplidar_a2"), planar(), {0.203, 0.067}, {0.10, 0.03}}}},
          {"Effect of loop closure on pose error (C3, E-sim)",
           {open, closed,
            {"RoboSense Airy, open loop", campus("airy"), front_end(), {0.404, 0.152}, {}},
            {"RoboSense Airy, + pose graph", campus("airy"), loops(), {0.585, 0.297}, {}}}},
          {"Comparison of the combinations (E-sim)", {c1, ring, c3}},
          {"The 560 m by 363 m loop, to the exact truth",
           {cycle_2, {"C3, open loop", grounds(), front_end(), {}, {0.3, 0.0}}, {"C3, + pose graph", grounds(), loops(), {}, {0.3, 0.0}}}},
          {"Recorded cycles, APE to the GPS track (E-bag)",
           {cycle_1, {"C3, campus, + pose graph", campus("vlp16"), loops(), {}, {}}, cycle_2,
            {"C3, 560 m x 363 m, + pose graph", grounds(), loops(), {}, {}}},
           true}};
}

/// Of one row, all seeds.
struct Ours {
  std::vector<const Run*> runs;
  Spread ape_m{}, rpe_m{};
};

bool is_of(const Run& run, const PaperRow& row) {
  DriveName drive = row.drive;
  drive.seed = run.drive.seed;
  drive.length_m = run.drive.length_m;
  return drive.text() == run.drive.text() && run.configuration == row.configuration.name;
}

Ours ours_of(const PaperRow& row, const std::vector<Run>& runs, bool to_gps) {
  Ours ours;
  std::vector<double> ape, rpe;
  for (const Run& run : runs) {
    if (!is_of(run, row)) continue;
    ours.runs.push_back(&run);
    ape.push_back(to_gps ? run.ape_to_gps.rmse : run.ape.rmse);
    rpe.push_back(run.rpe.rmse);
  }
  ours.ape_m = spread(ape);
  ours.rpe_m = spread(rpe);
  return ours;
}

std::string cell(double value) { return value > 0.0 ? format("%.3f", value) : ""; }

std::string cell(const Spread& s, std::size_t runs) {
  return runs == 1 ? format("%.4f", s.median) : text(s, "%.4f");
}

std::string markdown(const PaperTable& table, const std::vector<Run>& runs) {
  const char* ape = table.to_gps ? "APE to GPS" : "APE";
  std::string out = "## " + table.title + "\n\n" +
                    format("| | paper: %s | RPE | ours: %s | RPE | bar: %s | RPE |\n", ape, ape, ape) +
                    "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const PaperRow& row : table.rows) {
    const Ours ours = ours_of(row, runs, table.to_gps);
    const ErrorPair bar = table.to_gps ? ErrorPair{} : row.bar;
    out += "| " + row.label + " | " + cell(row.paper.ape_m) + " | " + cell(row.paper.rpe_m) + " | " +
           cell(ours.ape_m, ours.runs.size()) + " | " + cell(ours.rpe_m, ours.runs.size()) + " | " + cell(bar.ape_m) + " | " +
           cell(bar.rpe_m) + " |\n";
  }
  return out + "\n";
}

std::string statistics_row(const std::string& label, const Statistics& s, const char* number) {
  const std::string pattern = std::string("| %s | ") + number + " | " + number + " | " + number + " | " + number + " |\n";
  return format(pattern.c_str(), label.c_str(), s.mean, s.median, s.rmse, s.max);
}

/// Table "Pose Error for C3 FAST-LIO2 Front-End (E-sim)" and ours, a line a seed.
std::string front_end_markdown(const std::vector<Run>& runs) {
  std::string out = "## Pose error of the 3D front end (C3, E-sim)\n\n| | mean | median | RMSE | max |\n| --- | --- | --- | --- | --- |\n";
  out += statistics_row("paper: APE", kPaperFrontEndApe, "%.3f") + statistics_row("paper: RPE", kPaperFrontEndRpe, "%.3f");
  const PaperRow row{"", campus("vlp16"), front_end(), {}, {}};
  for (const Run* run : ours_of(row, runs, false).runs) {
    out += statistics_row("ours, " + run->drive.text() + ": APE (bar: RMSE 0.030, max 0.150)", run->ape, "%.4f") +
           statistics_row("ours, " + run->drive.text() + ": RPE", run->rpe, "%.4f");
  }
  return out + "\n";
}

nlohmann::ordered_json json_of(const ErrorPair& pair) {
  if (pair.ape_m <= 0.0 && pair.rpe_m <= 0.0) return nullptr;
  return {{"ape_rmse_m", pair.ape_m}, {"rpe_rmse_m", pair.rpe_m}};
}

nlohmann::ordered_json json_of(const Statistics& s) {
  return {{"mean", s.mean}, {"median", s.median}, {"rmse", s.rmse}, {"max", s.max}};
}

nlohmann::ordered_json json_of(const Run& run) {
  return {{"drive", run.drive.text()},   {"configuration", run.configuration}, {"driven_m", run.driven_m},
          {"closures", run.closures},    {"ape_m", json_of(run.ape)},          {"rpe_m", json_of(run.rpe)},
          {"ape_to_gps_m", run.ape_to_gps.count > 0 ? json_of(run.ape_to_gps) : nullptr}};
}

}  // namespace

const std::vector<PaperTable>& paper_tables() {
  static const std::vector<PaperTable> kAll = make_tables();
  return kAll;
}

std::vector<Plan> paper_plans(const std::vector<std::uint64_t>& seeds, double length_m) {
  std::vector<Plan> plans;
  for (const std::uint64_t seed : seeds) {
    for (const PaperTable& table : paper_tables()) {
      for (const PaperRow& row : table.rows) {
        DriveName drive = row.drive;
        drive.seed = seed;
        drive.length_m = length_m;
        auto plan = std::ranges::find(plans, drive.text(), [](const Plan& p) { return p.drive.text(); });
        if (plan == plans.end()) plan = plans.insert(plans.end(), {drive, {}});
        const bool there = std::ranges::count(plan->configurations, row.configuration.name, &Configuration::name) > 0;
        if (!there) plan->configurations.push_back(row.configuration);
      }
    }
  }
  return plans;
}

std::string paper_markdown(const std::vector<Run>& runs) {
  std::string out = "# The paper's tables, and ours\n\nRMSE in metres; several seeds: least / median / most. Ours are simulated drives with exact "
                    "truth; APE SE(3)-aligned, RPE over 1 m, planar runs by x, y and heading (the ground of the "
                    "campus is not level). The paper's are Gazebo (E-sim) and its campus recordings (E-bag).\n\n";
  for (const PaperTable& table : paper_tables()) out += markdown(table, runs);
  return out + front_end_markdown(runs);
}

nlohmann::ordered_json paper_json(const std::vector<Run>& runs) {
  nlohmann::ordered_json tables = nlohmann::json::array();
  for (const PaperTable& table : paper_tables()) {
    nlohmann::ordered_json rows = nlohmann::json::array();
    for (const PaperRow& row : table.rows) {
      nlohmann::ordered_json of_row = nlohmann::json::array();
      for (const Run* run : ours_of(row, runs, table.to_gps).runs) of_row.push_back(json_of(*run));
      rows.push_back({{"label", row.label}, {"paper", json_of(row.paper)}, {"bar", json_of(row.bar)}, {"runs", of_row}});
    }
    tables.push_back({{"title", table.title}, {"ape_to_gps", table.to_gps}, {"rows", rows}});
  }
  return {{"tables", tables}};
}

}  // namespace slamd::eval
