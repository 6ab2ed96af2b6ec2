#pragma once
// Makes runs: a drive by slam-sim (kept and used again), each configuration by slam-replay, errors by this library.

#include <filesystem>
#include <vector>

#include "tools/progress/progress.hpp"
#include "tools/slam-eval/tables/run_table.hpp"

namespace slamd::eval {

struct RunMakerOptions {
  std::string slam_sim;            // paths
  std::string slam_replay;
  std::string config;              // of slam-replay; empty = its defaults
  std::filesystem::path work;      // WORK/drives/DRIVE (kept), WORK/runs/DRIVE/CONFIGURATION (overwritten)
  std::vector<std::string> faults; // of slam-sim, for every drive; WORK belongs to one set of them
  int jobs = 1;                    // drives at a time
};

/// Where slam-replay has put what it made of a drive in a configuration (its name).
std::filesystem::path run_folder(const RunMakerOptions& options, const DriveName& drive, const std::string& configuration);
/// Where the truth of a drive is.
std::filesystem::path truth_path(const RunMakerOptions& options, const DriveName& drive);

/// Every drive in each of its configurations, in that order. Progress counts runs, a drive that is to be made for one. Throws
/// InputError when a program fails; runs under way are ended first.
std::vector<Run> make_runs(const RunMakerOptions& options, const std::vector<Plan>& plans, Progress& progress);

/// How many steps of progress that is.
std::size_t count_steps(const std::vector<Plan>& plans);

}  // namespace slamd::eval
