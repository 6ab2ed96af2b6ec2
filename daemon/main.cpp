// slamd: reads the command line, loads the configuration and starts the daemon. Nothing else happens here.

#include <CLI/CLI.hpp>
#include <iostream>
#include <string>

#include "daemon/rt_check.hpp"
#include "daemon/run.hpp"

namespace {

struct Arguments {
  slamd::Launch launch;
  bool check = false;
  bool print_config = false;
  bool rt_check = false;
};

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  slamd::Launch& launch = arguments.launch;
  CLI::App cli{"slamd: real-time LiDAR-inertial-GNSS SLAM daemon"};
  cli.add_option("--config", launch.config_path, "YAML file; without it the built-in defaults hold");
  cli.add_option("--set", launch.overrides, "key=value, e.g. imu.device=/dev/ttyACM0; wins over the file")
      ->allow_extra_args(false);
  cli.add_option("--record", launch.record_folder,
                 "record all that the sensors send as a drive folder, or as an MCAP file when it ends in .mcap, for slam-replay");
  cli.add_flag("--check", arguments.check, "read the configuration, say what is wrong with it, do not start");
  cli.add_flag("--print-config", arguments.print_config, "print the effective configuration as YAML, do not start");
  cli.add_flag("--rt-check", arguments.rt_check,
               "say what of this machine keeps slamd from real time and how to mend it, do not start; exit code 1 when\n"
               "something is wrong");
  cli.set_version_flag("--version", SLAMD_VERSION);
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return cli.exit(error) == 0 ? slamd::kExitDone : slamd::kExitConfig;
  }

  const auto config = slamd::load_config(launch.config_path, launch.overrides);
  for (const std::string& fault : config.faults) std::cerr << fault << '\n';
  if (!config.faults.empty()) return slamd::kExitConfig;
  if (arguments.print_config) std::cout << slamd::print_config(config.value);
  if (arguments.check || arguments.print_config) return slamd::kExitDone;
  if (arguments.rt_check) return slamd::check_real_time(config.value, std::cout);
  return slamd::run_daemon(launch, config.value, SLAMD_VERSION);
}
