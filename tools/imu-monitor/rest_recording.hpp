#pragma once
// A recording of the IMU at rest, axis by axis: read from imu.csv, and its Allan figures as text and picture.

#include <array>
#include <iosfwd>
#include <string>
#include <vector>

#include "tools/imu-monitor/allan.hpp"

namespace slamd::monitor {

constexpr std::size_t kAxes = 6;  // gyro x y z [rad/s], accelerometer x y z [m/s^2]

struct RestRecording {
  std::array<std::vector<double>, kAxes> axes;
  double period_s = 0.0;      // the true one, from the stamps
  std::uint64_t missing = 0;  // samples that the file does not have
  std::uint64_t refused = 0;  // lines that are none
  std::string refusal;        // empty: can be evaluated
};

/// Lines of imu.csv (see drivers/imu). Refused: fewer than 1,000 samples.
RestRecording read_rest_recording(std::istream& lines);

struct AllanAxis {
  std::vector<AllanPoint> curve;
  AllanFigures figures;
};
using AllanResult = std::array<AllanAxis, kAxes>;

AllanResult evaluate(const RestRecording& recording);

/// The table of all axes, and the four lines for slamd.yaml: of the worst axis each, since the filter knows one figure
/// for all three.
std::string allan_report(const RestRecording& recording, const AllanResult& result);

/// Both charts, log-log. Throws plot::PlotError when the file cannot be written.
void draw_allan(const AllanResult& result, const std::string& path);

}  // namespace slamd::monitor
