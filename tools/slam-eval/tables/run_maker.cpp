#include "tools/slam-eval/tables/run_maker.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <fstream>
#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "tools/slam-eval/alignment.hpp"
#include "tools/slam-eval/association.hpp"
#include "tools/slam-eval/tables/child_process.hpp"
#include "tools/slam-eval/tables/gps_track.hpp"

namespace slamd::eval {
namespace {

namespace fs = std::filesystem;

double length_m(const std::vector<Pose>& poses) {
  double sum = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) sum += (poses[i].translation - poses[i - 1].translation).norm();
  return sum;
}

void evaluate(const fs::path& truth_file, const fs::path& estimate_file, bool in_plane, Run& run) {
  const Trajectory truth = load_trajectory(truth_file, TrajectoryFormat::kTum);
  const Trajectory estimate = load_trajectory(estimate_file, TrajectoryFormat::kTum);
  MatchedPoses matched = associate(truth, estimate, {.interpolate = true});
  if (in_plane) project_to_plane(matched);
  const Similarity over_truth = fit(Alignment::kSe3Umeyama, matched.truth, matched.estimate);
  constexpr PoseRelation kDistance = PoseRelation::kTranslationPart;
  run.driven_m = length_m(matched.truth);
  run.ape = statistics(ape(matched.truth, aligned(over_truth, matched.estimate), kDistance));
  const std::vector<PosePair> pairs = pose_pairs(matched.estimate, {.delta = 1.0, .unit = DeltaUnit::kMetres});
  run.rpe = statistics(rpe(matched.truth, matched.estimate, pairs, kDistance));
  run.ape_to_gps = ape_to_gps(load_gps_track(truth_file.parent_path()), estimate);
}

std::uint64_t closures_of(const fs::path& report) {
  const nlohmann::json json = nlohmann::json::parse(std::ifstream{report}, nullptr, false);
  return json.contains("back_end") ? json["back_end"].value("closures", std::uint64_t{0}) : 0;
}

/// The drive's folder appears when it is whole.
void make_drive(const RunMakerOptions& options, const DriveName& drive) {
  const fs::path folder = options.work / "drives" / drive.text();
  if (fs::exists(folder)) return;
  const fs::path part = folder.string() + ".part";
  fs::remove_all(part);
  fs::create_directories(part.parent_path());
  std::vector<std::string> command{options.slam_sim, "--scenario", drive.scenario, "--seed", std::to_string(drive.seed),
                                   "--quiet", "--threads", "1", "--out", part.string()};
  if (drive.length_m > 0.0) command.insert(command.end(), {"--length", std::to_string(drive.length_m)});
  if (!drive.lidar.empty()) command.insert(command.end(), {"--lidar", drive.lidar});
  command.insert(command.end(), drive.options.begin(), drive.options.end());
  for (const std::string& fault : options.faults) command.insert(command.end(), {"--fault", fault});
  run_program(command, folder.string() + ".log");
  fs::rename(part, folder);
}

Run make_run(const RunMakerOptions& options, const DriveName& drive, const Configuration& configuration) {
  const fs::path out = run_folder(options, drive, configuration.name);
  fs::create_directories(out);
  std::vector<std::string> command{options.slam_replay, (options.work / "drives" / drive.text()).string(), "--quiet",
                                   "--out", out.string()};
  if (!options.config.empty()) command.insert(command.end(), {"--config", options.config});
  command.insert(command.end(), configuration.replay_options.begin(), configuration.replay_options.end());
  run_program(command, (out / "log").string());
  Run run{.drive = drive, .configuration = configuration.name, .closures = closures_of(out / "report.json")};
  evaluate(truth_path(options, drive), out / configuration.trajectory, configuration.in_plane, run);
  return run;
}

/// Work shared by the threads: drives are taken in order, the first failure ends all.
class Jobs {
 public:
  Jobs(const RunMakerOptions& options, const std::vector<Plan>& plans, Progress& progress)
      : options_{options}, plans_{plans}, progress_{progress}, runs_(plans.size()) {}

  void work() {
    for (std::size_t i = next_++; i < plans_.size() && !failed_; i = next_++) {
      try {
        take(i);
      } catch (...) {
        const std::lock_guard lock{mutex_};
        if (!failed_) failure_ = std::current_exception();
        failed_ = true;
      }
    }
  }

  std::vector<Run> result() {
    if (failure_) std::rethrow_exception(failure_);
    std::vector<Run> all;
    for (std::vector<Run>& runs : runs_) std::ranges::move(runs, std::back_inserter(all));
    return all;
  }

 private:
  void take(std::size_t i) {
    const DriveName& drive = plans_[i].drive;
    show(drive.text(), 0.0);
    make_drive(options_, drive);
    show(drive.text(), 1.0);
    for (const Configuration& configuration : plans_[i].configurations) {
      if (failed_) return;
      runs_[i].push_back(make_run(options_, drive, configuration));
      show(drive.text() + " " + configuration.name, 1.0);
    }
  }

  void show(const std::string& what, double done) {
    const std::lock_guard lock{mutex_};
    done_ += done;
    progress_.show(done_, what);
  }

  const RunMakerOptions& options_;
  const std::vector<Plan>& plans_;
  Progress& progress_;
  std::vector<std::vector<Run>> runs_;  // of each plan
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  double done_ = 0.0;
  std::exception_ptr failure_;
};

}  // namespace

fs::path run_folder(const RunMakerOptions& options, const DriveName& drive, const std::string& configuration) {
  return options.work / "runs" / drive.text() / configuration;
}

fs::path truth_path(const RunMakerOptions& options, const DriveName& drive) {
  return options.work / "drives" / drive.text() / "truth.tum";
}

std::size_t count_steps(const std::vector<Plan>& plans) {
  std::size_t steps = 0;
  for (const Plan& plan : plans) steps += 1 + plan.configurations.size();
  return steps;
}

std::vector<Run> make_runs(const RunMakerOptions& options, const std::vector<Plan>& plans, Progress& progress) {
  Jobs jobs{options, plans, progress};
  {
    std::vector<std::jthread> helpers;
    for (int i = 1; i < options.jobs; ++i) helpers.emplace_back([&jobs] { jobs.work(); });
    jobs.work();
  }
  return jobs.result();
}

}  // namespace slamd::eval
