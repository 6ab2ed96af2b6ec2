#pragma once
// Logs of the robot CARMEN, the form of the classic 2D SLAM recordings (.log, .clf, also .gz): odometry and laser scans. Read
// as a whole, since its stamps have to be put in order; no other sensor of such a log is used.

#include <string>
#include <string_view>
#include <vector>

#include "tools/slam-replay/drive/sensors.hpp"

namespace slamd::replay {

/// The order of records is the order in which the robot moved; stamps that step back, or ahead of what follows, are put between
/// their neighbours (`recorded_stamps` keeps what was written). Times are those of the log, seconds since 1970 as a rule.
struct CarmenLog {
  std::vector<WheelOdometry> wheels;  // of ODOM, FLASER and ROBOTLASER1, each place and stamp once
  std::vector<LaserScan> scans;       // of FLASER and ROBOTLASER1
  double laser_forward_m = 0.0;       // of robot_frontlaser_offset: where the laser sits in base
  std::map<HostTime, HostTime> recorded_stamps;  // by repaired time, where the two differ
  std::uint64_t bad_lines = 0;
  std::uint64_t stamps_repaired = 0;
  std::vector<std::string> faults;    // "FILE:LINE: reason" of the first ones; of the file when it cannot be read at all

  bool is_empty() const { return scans.empty() && wheels.empty(); }
};

/// A line that cannot be read is counted and skipped; a file that is cut off gives what is whole. Never throws.
CarmenLog read_carmen_log(const std::string& path);

/// Whether the name ends as those of such logs do: .clf or .log, with or without .gz.
bool is_carmen_name(std::string_view path);

/// The log as the streams of a drive.
Sensors sensors_of(CarmenLog log);

}  // namespace slamd::replay
