#include "tools/slam-eval/tables/run_maker.hpp"

#include <atomic>
#include <exception>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "tools/slam-eval/alignment.hpp"
#include "tools/slam-eval/association.hpp"
#include "tools/slam-eval/tables/child_process.hpp"

namespace slamd::eval {
namespace {

namespace fs = std::filesystem;

double length_m(const std::vector<Pose>& poses) {
  double sum = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) sum += (poses[i].translation - poses[i - 1].translation).norm();
  return sum;
}

void evaluate(const fs::path& truth_file, const fs::path& estimate_file, Run& run) {
  const Trajectory truth = load_trajectory(truth_file, TrajectoryFormat::kTum);
  const Trajectory estimate = load_trajectory(estimate_file, TrajectoryFormat::kTum);
  const MatchedPoses matched = associate(truth, estimate, {.interpolate = true});
  const Similarity over_truth = fit(Alignment::kSe3Umeyama, matched.truth, matched.estimate);
  constexpr PoseRelation kDistance = PoseRelation::kTranslationPart;
  run.driven_m = length_m(matched.truth);
  run.ape = statistics(ape(matched.truth, aligned(over_truth, matched.estimate), kDistance));
  const std::vector<PosePair> pairs = pose_pairs(matched.estimate, {.delta = 1.0, .unit = DeltaUnit::kMetres});
  run.rpe = statistics(rpe(matched.truth, matched.estimate, pairs, kDistance));
}

std::uint64_t closures_of(const fs::path& report) {
  const nlohmann::json json = nlohmann::json::parse(std::ifstream{report}, nullptr, false);
  return json.contains("back_end") ? json["back_end"].value("closures", std::uint64_t{0}) : 0;
}

fs::path run_folder(const RunMakerOptions& options, const DriveName& drive, const Configuration& configuration) {
  return options.work / "runs" / drive.text() / configuration.name;
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
  for (const std::string& fault : options.faults) command.insert(command.end(), {"--fault", fault});
  run_program(command, folder.string() + ".log");
  fs::rename(part, folder);
}

Run make_run(const RunMakerOptions& options, const DriveName& drive, const Configuration& configuration) {
  const fs::path out = run_folder(options, drive, configuration);
  fs::create_directories(out);
  std::vector<std::string> command{options.slam_replay, (options.work / "drives" / drive.text()).string(), "--quiet",
                                   "--out", out.string()};
  if (!options.config.empty()) command.insert(command.end(), {"--config", options.config});
  command.insert(command.end(), configuration.replay_options.begin(), configuration.replay_options.end());
  run_program(command, (out / "log").string());
  Run run{.drive = drive, .configuration = configuration.name, .closures = closures_of(out / "report.json")};
  evaluate(truth_path(options, drive), out / configuration.trajectory, run);
  return run;
}

/// Work shared by the threads: drives are taken in order, the first failure ends all.
class Jobs {
 public:
  Jobs(const RunMakerOptions& options, const std::vector<DriveName>& drives,
       const std::vector<Configuration>& configurations, Progress& progress)
      : options_{options}, drives_{drives}, configurations_{configurations}, progress_{progress},
        runs_(drives.size() * configurations.size()) {}

  void work() {
    for (std::size_t i = next_++; i < drives_.size() && !failed_; i = next_++) {
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
    return std::move(runs_);
  }

 private:
  void take(std::size_t i) {
    show(drives_[i].text(), 0.0);
    make_drive(options_, drives_[i]);
    show(drives_[i].text(), 1.0);
    for (std::size_t k = 0; k < configurations_.size() && !failed_; ++k) {
      runs_[i * configurations_.size() + k] = make_run(options_, drives_[i], configurations_[k]);
      show(drives_[i].text() + " " + configurations_[k].name, 1.0);
    }
  }

  void show(const std::string& what, double done) {
    const std::lock_guard lock{mutex_};
    done_ += done;
    progress_.show(done_, what);
  }

  const RunMakerOptions& options_;
  const std::vector<DriveName>& drives_;
  const std::vector<Configuration>& configurations_;
  Progress& progress_;
  std::vector<Run> runs_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  double done_ = 0.0;
  std::exception_ptr failure_;
};

}  // namespace

fs::path trajectory_path(const RunMakerOptions& options, const DriveName& drive, const Configuration& configuration) {
  return run_folder(options, drive, configuration) / configuration.trajectory;
}

fs::path truth_path(const RunMakerOptions& options, const DriveName& drive) {
  return options.work / "drives" / drive.text() / "truth.tum";
}

std::vector<Run> make_runs(const RunMakerOptions& options, const std::vector<DriveName>& drives,
                           const std::vector<Configuration>& configurations, Progress& progress) {
  Jobs jobs{options, drives, configurations, progress};
  {
    std::vector<std::jthread> helpers;
    for (int i = 1; i < options.jobs; ++i) helpers.emplace_back([&jobs] { jobs.work(); });
    jobs.work();
  }
  return jobs.result();
}

}  // namespace slamd::eval
