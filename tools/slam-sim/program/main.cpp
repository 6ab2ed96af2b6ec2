// slam-sim: simulated drives as wire bytes, to a folder or in real time.

#include <cstdio>
#include <exception>

#include "tools/slam-sim/program/run.hpp"

int main(int argc, char** argv) {
  const auto parsed = slamd::sim::parse_command_line(argc, argv);
  if (!parsed.options) return parsed.exit_code;
  try {
    return parsed.options->live ? slamd::sim::run_live(*parsed.options) : slamd::sim::run_folder(*parsed.options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slam-sim: %s\n", error.what());
    return 1;
  }
}
