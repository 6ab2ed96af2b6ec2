#pragma once
// The life of the daemon's process from a good configuration to its exit code: signals, what the service manager is told,
// reloads. What the daemon does meanwhile is the app's.

#include <string>
#include <vector>

#include "daemon/config/config.hpp"

namespace slamd {

constexpr int kExitDone = 0;
constexpr int kExitFailure = 1;  // the start failed, or a thread ended by itself
constexpr int kExitConfig = 2;   // bad command line or configuration

/// What the command line asked for.
struct Launch {
  std::string config_path;             // read again by a reload
  std::vector<std::string> overrides;  // likewise
  std::string record_folder;
};

/// Runs until SIGTERM or SIGINT; SIGHUP reloads. `config` is what `launch` says. Returns the exit code.
int run_daemon(const Launch& launch, const Config& config, const std::string& version);

}  // namespace slamd
