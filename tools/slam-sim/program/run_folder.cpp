#include <cmath>

#include "tools/slam-sim/output/drive_folder.hpp"
#include "tools/slam-sim/output/stop_signals.hpp"
#include "tools/progress/progress.hpp"
#include "tools/slam-sim/program/run.hpp"

namespace slamd::sim {

int run_folder(const Options& options) {
  StopSignals stop;
  DriveFolder folder{options.out, {std::llround(options.host_start_s * 1e9), options.drive.lidar_kind, options.drive.rplidar, options.serial_bytes}};
  Simulation simulation{options.drive};
  Progress progress{options.scenario, simulation.duration(), options.quiet};
  std::uint64_t events = 0;
  while (!simulation.done() && !stop.pending()) {
    for (const WireEvent& event : simulation.next_slice()) {
      folder.write(event);
      ++events;
    }
    progress.show(simulation.time());
  }
  folder.write_vehicle(simulation.vehicle());
  folder.write_truth(simulation.trajectory(), simulation.time());
  progress.finish(options.out + ": " + std::to_string(simulation.time()) + " s, " + std::to_string(events) +
                  " packets and sentences" + (simulation.done() ? "" : " (interrupted)"));
  return simulation.done() ? 0 : 130;
}

}  // namespace slamd::sim
