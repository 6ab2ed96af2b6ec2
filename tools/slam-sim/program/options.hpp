#pragma once
// What the command line of slam-sim asks for, as a value. It runs nothing.

#include <optional>
#include <string>

#include "tools/slam-sim/sensors/simulation.hpp"

namespace slamd::sim {

struct LiveOptions {
  std::string udp_host = "127.0.0.1";
  LidarPorts ports{0, 0, 0};  // 0 = the LiDAR's own
  std::string lidar_pty;
  std::string imu_pty;  // symlinks to the slaves; empty = none
  std::string gps_pty;
  std::string wheel_pty;
  std::string truth;       // TUM file; empty = none
  std::string imu_motion;  // CSV of the IMU's exact motion; empty = none
  double start_delay_s = 1.0;
};

struct Options {
  DriveSpec drive;
  std::string scenario = "campus";
  std::string out;
  double host_start_s = 1000.0;
  bool serial_bytes = false;
  bool live = false;
  bool quiet = false;
  LiveOptions live_options;
};

/// The options, or the exit code after a message has been printed (0 for --help).
struct Parsed {
  std::optional<Options> options;
  int exit_code = 0;
};
Parsed parse_command_line(int argc, char** argv);

}  // namespace slamd::sim
