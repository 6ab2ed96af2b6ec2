#pragma once
// One line of a CARMEN log as a record. It reads no file and knows nothing of other lines.

#include <optional>
#include <string_view>
#include <vector>

#include "estimator/types/laser_scan.hpp"

namespace slamd::replay {

struct CarmenRecord {
  double time_s = 0.0;
  double x_m = 0.0, y_m = 0.0, yaw_rad = 0.0;  // of the robot by its wheels
  std::optional<LaserScan> scan;               // without times
};

/// What a line says. `reason` is set when it is a record that cannot be read; neither: a line that is of no use here.
struct CarmenLine {
  std::optional<CarmenRecord> record;
  std::optional<double> laser_forward_m;  // PARAM robot_frontlaser_offset
  const char* reason = nullptr;
};

CarmenLine parse_carmen_line(std::string_view line);

constexpr std::size_t kMostCarmenBeams = 8192;

}  // namespace slamd::replay
