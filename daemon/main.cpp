// slamd: reads the command line, loads the configuration and starts the app. Nothing else happens here.

#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"

namespace {

constexpr int kExitConfig = 2;  // bad command line or configuration

struct Arguments {
  std::string config_path;
  std::vector<std::string> overrides;
  bool check = false;
  bool print_config = false;
};

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App cli{"slamd: real-time LiDAR-inertial-GNSS SLAM daemon"};
  cli.add_option("--config", arguments.config_path, "YAML file; without it the built-in defaults hold");
  cli.add_option("--set", arguments.overrides, "key=value, e.g. imu.device=/dev/ttyACM0; wins over the file")
      ->allow_extra_args(false);
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
  return 0;
}
