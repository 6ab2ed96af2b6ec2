// slam-eval tables: drives, runs and the tables of them, in one command.

#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>
#include <memory>
#include <set>
#include <thread>

#include "tools/slam-eval/program/commands.hpp"
#include "tools/slam-eval/tables/before_after.hpp"
#include "tools/slam-eval/tables/child_process.hpp"
#include "tools/slam-eval/tables/loop_closure_table.hpp"
#include "tools/slam-eval/tables/paper_pictures.hpp"
#include "tools/slam-eval/tables/paper_tables.hpp"
#include "tools/slam-eval/tables/run_maker.hpp"

namespace slamd::eval {
namespace {

namespace fs = std::filesystem;

struct TablesOptions {
  std::vector<std::string> scenarios;  // none: the paper's tables
  std::vector<std::string> seeds;
  double length_m = 0.0;
  std::string out;
  RunMakerOptions maker;
  bool quiet = false;
};

/// "3" or "1-10". Throws InputError.
void add_seeds(const std::string& word, std::vector<std::uint64_t>& seeds) {
  constexpr std::uint64_t kMost = 1000;
  std::uint64_t first = 0, last = 0;
  char dash = 0;
  std::istringstream in{word};
  const bool single = word.find('-') == std::string::npos;
  const bool read = single ? bool(in >> first) : bool(in >> first >> dash >> last);
  if (single) last = first;
  if (!read || in.peek() != std::istringstream::traits_type::eof() || last < first || last - first >= kMost) {
    throw InputError("--seeds " + word + ": a number or FIRST-LAST, at most " + std::to_string(kMost));
  }
  for (std::uint64_t seed = first; seed <= last; ++seed) seeds.push_back(seed);
}

std::vector<std::uint64_t> seeds_of(const TablesOptions& o) {
  std::vector<std::uint64_t> seeds;
  for (const std::string& word : o.seeds) add_seeds(word, seeds);
  return seeds;
}

/// Drives without the back end and with parts of it.
std::vector<Plan> ablation_plans(const TablesOptions& o) {
  std::vector<Plan> plans;
  for (const std::string& scenario : o.scenarios) {
    for (const std::uint64_t seed : seeds_of(o)) {
      plans.push_back({{.scenario = scenario, .seed = seed, .length_m = o.length_m}, loop_closure_configurations()});
    }
  }
  return plans;
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream out{path};
  out << text;
  if (!out.flush()) throw InputError(path.string() + ": cannot be written");
}

void draw_ablation(const TablesOptions& o, const DriveName& drive) {
  const Trajectory truth = load_trajectory(truth_path(o.maker, drive), TrajectoryFormat::kTum);
  std::vector<LabelledPath> paths;
  for (const Configuration& configuration : loop_closure_configurations()) {
    const fs::path file = run_folder(o.maker, drive, configuration.name) / configuration.trajectory;
    const Trajectory estimate = load_trajectory(file, TrajectoryFormat::kTum);
    paths.push_back({configuration.label, associate(truth, estimate, {.interpolate = true})});
  }
  write_before_after(drive.text(), paths, (fs::path{o.out} / (drive.text() + ".png")).string());
}

std::vector<Run> runs_of(const TablesOptions& o, const std::vector<Plan>& plans) {
  Progress progress{"tables", static_cast<double>(count_steps(plans)), o.quiet, "steps"};
  std::vector<Run> runs = make_runs(o.maker, plans, progress);
  progress.finish("tables.md, tables.json and pictures are being written to " + o.out);
  return runs;
}

void write_tables(const TablesOptions& o, const std::string& markdown, const nlohmann::ordered_json& json) {
  write_text(fs::path{o.out} / "tables.md", markdown);
  write_text(fs::path{o.out} / "tables.json", json.dump(2) + "\n");
  std::cout << markdown;
}

/// What the back end does to the error; one picture a scenario, of its first seed.
void run_ablation(const TablesOptions& o) {
  const std::vector<Plan> plans = ablation_plans(o);
  const std::vector<Run> runs = runs_of(o, plans);
  std::set<std::string> drawn;
  for (const Plan& plan : plans) {
    if (drawn.insert(plan.drive.scenario).second) draw_ablation(o, plan.drive);
  }
  write_tables(o, loop_closure_markdown(runs), loop_closure_json(runs));
}

/// Every table of the paper; figures of the first seed.
void run_paper(const TablesOptions& o) {
  const std::vector<std::uint64_t> seeds = seeds_of(o);
  const std::vector<Run> runs = runs_of(o, paper_plans(seeds, o.length_m));
  const std::vector<Figure> figures = draw_figures(o.maker, paper_plans({seeds.front()}, o.length_m), o.out);
  write_tables(o, paper_markdown(runs) + figures_markdown(figures), paper_json(runs));
}

void run_tables(TablesOptions o) {
  if (o.maker.slam_sim.empty()) o.maker.slam_sim = find_sibling("slam-sim");
  if (o.maker.slam_replay.empty()) o.maker.slam_replay = find_sibling("slam-replay");
  if (o.maker.work.empty()) o.maker.work = fs::path{o.out} / "work";
  const bool paper = o.scenarios.empty();
  if (o.seeds.empty()) o.seeds = {paper ? "1" : "1-3"};
  fs::create_directories(o.out);
  paper ? run_paper(o) : run_ablation(o);
}

}  // namespace

void add_tables(CLI::App& app) {
  auto* command = app.add_subcommand("tables", "every table and figure of the paper beside ours, from simulated drives; --scenario: what parts of the back end do to the error");
  auto o = std::make_shared<TablesOptions>();
  o->maker.jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  command->add_option("--out", o->out, "folder for tables.md, tables.json and pictures (of the first seed)")->required();
  command->add_option("--scenario", o->scenarios, "of slam-sim, one or more: front end only, + loops, + GPS, + both on each (default: the paper's tables)");
  command->add_option("--seeds", o->seeds, "numbers and ranges FIRST-LAST (default: 1; with --scenario 1-3)");
  command->add_option("--length", o->length_m, "end every drive after this many metres (0 = all of it)")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--fault", o->maker.faults, "of slam-sim, for every drive; take another --work for other faults");
  command->add_option("--config", o->maker.config, "slamd.yaml of slam-replay (default: built-in)")->check(CLI::ExistingFile);
  command->add_option("--work", o->maker.work, "folder for drives, which are used again, and runs (default: OUT/work)");
  command->add_option("--slam-sim", o->maker.slam_sim, "the program (default: beside slam-eval)")->check(CLI::ExistingFile);
  command->add_option("--slam-replay", o->maker.slam_replay, "the program (default: beside slam-eval)")->check(CLI::ExistingFile);
  command->add_option("--jobs", o->maker.jobs, "drives at a time (default: one per core)")->check(CLI::Range(1, 256));
  command->add_flag("--quiet", o->quiet, "no progress");
  command->callback([o] { run_tables(*o); });
}

}  // namespace slamd::eval
