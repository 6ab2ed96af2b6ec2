#pragma once
// What each subcommand of slamctl does with its options. The command line itself is in main.cpp.

#include <slamd/client.hpp>

#include <optional>
#include <string>
#include <vector>

#include "daemon/doctor/doctor.hpp"

namespace slamd::slamctl {

/// Exit codes, part of the contract with scripts.
enum Exit { kOk = 0, kFailed = 1, kUsage = 2, kNoDaemon = 3, kNotTracking = 4 };

struct Options {
  std::string socket_path;
  bool json = false;
  double timeout_s = 60.0;
  bool follow = false;
  double rate_hz = 10.0;
  bool watch = false;
  std::uint64_t count = 0;  // poses to follow, looks at the status; 0 = for ever
  std::string file;
  double voxel_size_m = 0.2;
  double interval_s = 1.0;  // of top and of watching
  bool once = false;
  std::string sensor, verb;  // of inject
  double for_s = 10.0;
  std::string lidar_address = doctor::Wanted{}.lidar_address;
  double max_s = 0.0;   // of a recording; 0: the daemon's own limits
  double max_mb = 0.0;
  std::vector<double> box;  // min x y z, max x y z, or empty
};

/// To the socket of the options, with their patience. Throws ClientError.
client::Connection connect(const Options& options);

// Each prints to stdout (progress to stderr when that is a terminal) and returns the exit code; throws ClientError.
int show_status(client::Connection& daemon, const Options& options);
int show_metrics(client::Connection& daemon, const Options& options);
int show_top(client::Connection& daemon, const Options& options);
int show_pose(client::Connection& daemon, const Options& options);
int inject(client::Connection& daemon, const Options& options);
int save_map(client::Connection& daemon, const Options& options);
int save_grid(client::Connection& daemon, const Options& options);
int save_trajectory(client::Connection& daemon, const Options& options);
int dump(client::Connection& daemon, const Options& options);
int start_recording(client::Connection& daemon, const Options& options);
int stop_recording(client::Connection& daemon, const Options& options);

/// What is wrong with machine and daemon; kFailed when anything is, a daemon that does not answer among it.
int show_doctor(const Options& options);

}  // namespace slamd::slamctl
