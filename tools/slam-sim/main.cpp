#include <CLI/CLI.hpp>
#include <iostream>

#include "tools/slam-sim/output/drive_folder.hpp"
#include "tools/slam-sim/output/scenarios.hpp"

int main(int argc, char** argv) {
  using namespace slamd::sim;
  CLI::App app{"slam-sim"};
  std::string scenario = "campus", out;
  DriveSpec spec;
  app.add_option("--scenario", scenario);
  app.add_option("--seed", spec.seed);
  app.add_option("--duration", spec.max_duration_s);
  app.add_option("--threads", spec.threads);
  app.add_option("--out", out)->required();
  CLI11_PARSE(app, argc, argv);
  if (const Scenario* found = find_scenario(scenario)) found->apply(spec);
  Simulation simulation{spec};
  DriveFolder folder{out, 1'000'000'000'000};
  folder.write_vehicle(simulation.vehicle());
  folder.write_truth(simulation.trajectory(), simulation.duration());
  while (!simulation.done()) {
    for (const WireEvent& event : simulation.next_slice()) folder.write(event);
    std::cerr << '\r' << simulation.time() << " / " << simulation.duration() << std::flush;
  }
  std::cerr << '\n';
}
