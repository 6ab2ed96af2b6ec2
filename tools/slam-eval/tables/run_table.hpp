#pragma once
// Runs of the estimator with their errors, and what many runs of one kind come to. Starts no program, writes no file.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/slam-eval/metrics.hpp"

namespace slamd::eval {

/// A way to run slam-replay, and which of its trajectories counts.
struct Configuration {
  std::string name;                         // of its folder and in JSON
  std::string label;                        // in tables
  std::vector<std::string> replay_options;
  std::string trajectory;                   // file of slam-replay
  bool in_plane = false;                    // x, y and heading count alone
};

/// A simulated drive.
struct DriveName {
  std::string scenario;
  std::uint64_t seed = 1;
  double length_m = 0.0;  // 0 = the scenario's whole course
  std::string lidar{};    // of slam-sim --lidar; empty = the scenario's own
  std::vector<std::string> options{};  // of slam-sim beside those; part of what `variant` names
  std::string variant{};  // of drives that differ in options alone

  /// "campus-1", "campus-1-100m", "campus-1-airy": its folder.
  std::string text() const;
};

/// A drive, and the ways to run it.
struct Plan {
  DriveName drive;
  std::vector<Configuration> configurations;
};

struct Run {
  DriveName drive;
  std::string configuration;  // Configuration::name
  double driven_m = 0.0;      // along the truth
  std::uint64_t closures = 0; // in the last solution
  Statistics ape{};           // metres, SE(3)-aligned
  Statistics rpe{};           // metres over 1 m
  Statistics ape_to_gps{};    // horizontal metres to the receiver's track; count 0 where the drive has none
};

struct Spread {
  double least = 0.0;
  double median = 0.0;
  double most = 0.0;
};

/// The run of a drive (its text()) in a configuration (its name); null when it is not there.
const Run* find(const std::vector<Run>& runs, const std::string& drive, const std::string& configuration);

/// All zero for an empty list.
Spread spread(std::vector<double> values);

/// The runs of one scenario in one configuration. The ratios are run by run to the same drive in the first configuration.
struct Summary {
  std::string scenario;
  std::string configuration;
  std::size_t runs = 0;
  double driven_m = 0.0;  // mean
  Spread ape_m{};         // RMSE of each run
  Spread rpe_m{};
  Spread ape_ratio{};
  Spread rpe_ratio{};
  Spread closures{};
};

/// One a scenario and configuration, scenarios in order of appearance. A drive without a run in the first configuration
/// has no ratio.
std::vector<Summary> summarise(const std::vector<Run>& runs, const std::vector<Configuration>& configurations);

}  // namespace slamd::eval
