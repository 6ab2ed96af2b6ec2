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
#include "tools/slam-eval/tables/run_maker.hpp"

namespace slamd::eval {
namespace {

namespace fs = std::filesystem;

struct TablesOptions {
  std::vector<std::string> scenarios{"campus", "hills"};
  std::vector<std::string> seeds{"1-3"};
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

std::vector<DriveName> drives_of(const TablesOptions& o) {
  std::vector<std::uint64_t> seeds;
  for (const std::string& word : o.seeds) add_seeds(word, seeds);
  std::vector<DriveName> drives;
  for (const std::string& scenario : o.scenarios) {
    for (const std::uint64_t seed : seeds) drives.push_back({scenario, seed, o.length_m});
  }
  return drives;
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream out{path};
  out << text;
  if (!out.flush()) throw InputError(path.string() + ": cannot be written");
}

void draw(const TablesOptions& o, const DriveName& drive) {
  const Trajectory truth = load_trajectory(truth_path(o.maker, drive), TrajectoryFormat::kTum);
  std::vector<LabelledPath> paths;
  for (const Configuration& configuration : loop_closure_configurations()) {
    const Trajectory estimate = load_trajectory(trajectory_path(o.maker, drive, configuration), TrajectoryFormat::kTum);
    paths.push_back({configuration.label, associate(truth, estimate, {.interpolate = true})});
  }
  write_before_after(drive.text(), paths, (fs::path{o.out} / (drive.text() + ".png")).string());
}

/// One picture a scenario, of its first seed.
void draw_first_seeds(const TablesOptions& o, const std::vector<DriveName>& drives) {
  std::set<std::string> drawn;
  for (const DriveName& drive : drives) {
    if (drawn.insert(drive.scenario).second) draw(o, drive);
  }
}

void run_tables(TablesOptions o) {
  if (o.maker.slam_sim.empty()) o.maker.slam_sim = find_sibling("slam-sim");
  if (o.maker.slam_replay.empty()) o.maker.slam_replay = find_sibling("slam-replay");
  if (o.maker.work.empty()) o.maker.work = fs::path{o.out} / "work";
  fs::create_directories(o.out);
  const std::vector<DriveName> drives = drives_of(o);
  const std::vector<Configuration>& configurations = loop_closure_configurations();
  const double steps = static_cast<double>(drives.size() * (configurations.size() + 1));
  Progress progress{"tables", steps, o.quiet, "steps"};
  const std::vector<Run> runs = make_runs(o.maker, drives, configurations, progress);
  draw_first_seeds(o, drives);
  const std::string markdown = loop_closure_markdown(runs);
  write_text(fs::path{o.out} / "tables.md", markdown);
  write_text(fs::path{o.out} / "tables.json", loop_closure_json(runs).dump(2) + "\n");
  progress.finish("tables.md, tables.json and pictures written to " + o.out);
  std::cout << markdown;
}

}  // namespace

void add_tables(CLI::App& app) {
  auto* command = app.add_subcommand("tables", "simulate drives, run them with parts of the back end, print the paper's tables beside ours");
  auto o = std::make_shared<TablesOptions>();
  o->maker.jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  command->add_option("--out", o->out, "folder for tables.md, tables.json and pictures (of each scenario's first seed)")->required();
  command->add_option("--scenario", o->scenarios, "of slam-sim, one or more")->capture_default_str();
  command->add_option("--seeds", o->seeds, "numbers and ranges FIRST-LAST")->capture_default_str();
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
