// slamd: reads the command line, loads the configuration and starts the app. Nothing else happens here.

#include <systemd/sd-daemon.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>

#include "daemon/app.hpp"

namespace {

constexpr int kExitFailure = 1;  // the start failed, or a thread ended by itself
constexpr int kExitConfig = 2;   // bad command line or configuration

struct Arguments {
  std::string config_path;
  std::vector<std::string> overrides;
  std::string record_folder;
  bool check = false;
  bool print_config = false;
};

/// The signals that end the daemon, blocked in every thread and waited for in this one.
sigset_t block_stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return signals;
}

int run(const slamd::Config& config, const std::string& record_folder) {
  const sigset_t stop_signals = block_stop_signals();
  slamd::Result<std::unique_ptr<slamd::App>> app = slamd::App::open(config, SLAMD_VERSION, record_folder);
  const slamd::Result<void> started = app ? (*app)->start() : slamd::Error{app.reason()};
  if (!started) {
    std::cerr << "slamd: cannot start: " << started.reason() << '\n';
    return kExitFailure;
  }
  sd_notify(0, "READY=1");
  constexpr timespec kLookPeriod{0, 100'000'000};
  bool healthy = true;
  while (healthy && sigtimedwait(&stop_signals, nullptr, &kLookPeriod) < 0) healthy = (*app)->supervise();
  sd_notify(0, "STOPPING=1");
  (*app)->stop();
  return healthy ? 0 : kExitFailure;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App cli{"slamd: real-time LiDAR-inertial-GNSS SLAM daemon"};
  cli.add_option("--config", arguments.config_path, "YAML file; without it the built-in defaults hold");
  cli.add_option("--set", arguments.overrides, "key=value, e.g. imu.device=/dev/ttyACM0; wins over the file")
      ->allow_extra_args(false);
  cli.add_option("--record", arguments.record_folder,
                 "record all that the sensors send as a drive folder, for slam-replay");
  cli.add_flag("--check", arguments.check, "read the configuration, say what is wrong with it, do not start");
  cli.add_flag("--print-config", arguments.print_config, "print the effective configuration as YAML, do not start");
  cli.set_version_flag("--version", SLAMD_VERSION);
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return cli.exit(error) == 0 ? 0 : kExitConfig;
  }

  const auto config = slamd::load_config(arguments.config_path, arguments.overrides);
  for (const std::string& fault : config.faults) std::cerr << fault << '\n';
  if (!config.faults.empty()) return kExitConfig;
  if (arguments.print_config) std::cout << slamd::print_config(config.value);
  if (arguments.check || arguments.print_config) return 0;
  return run(config.value, arguments.record_folder);
}
