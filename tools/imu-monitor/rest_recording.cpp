#include "tools/imu-monitor/rest_recording.hpp"

#include <algorithm>
#include <cstdio>
#include <istream>

#include "drivers/imu/imu_csv_reader.hpp"

namespace slamd::monitor {
namespace {

constexpr std::size_t kFewestSamples = 1000;
constexpr const char* kAxisNames[kAxes] = {"gyro x", "gyro y", "gyro z", "accel x", "accel y", "accel z"};

double worst(const AllanResult& result, std::size_t first, double AllanFigures::*figure) {
  double largest = 0.0;
  for (std::size_t i = first; i < first + 3; ++i) largest = std::max(largest, result[i].figures.*figure);
  return largest;
}

std::string yaml_line(const char* key, double value, const char* unit) {
  char text[120];
  if (value > 0.0) {
    std::snprintf(text, sizeof text, "    %s: %.3g  # %s\n", key, value, unit);
  } else {
    std::snprintf(text, sizeof text, "    # %s: not seen, the recording is too short for it\n", key);
  }
  return text;
}

}  // namespace

RestRecording read_rest_recording(std::istream& lines) {
  RestRecording recording;
  ImuCsvReader reader{lines, SampleClock::Config{}};
  HostTime first{};
  HostTime last{};
  while (const std::optional<ImuSample> sample = reader.next()) {
    if (recording.axes[0].empty()) first = sample->time;
    last = sample->time;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      recording.axes[i].push_back(sample->gyro_rads[axis]);
      recording.axes[i + 3].push_back(sample->accel_mps2[axis]);
    }
  }
  const std::size_t count = recording.axes[0].size();
  recording.missing = reader.clock().missing();
  recording.refused = reader.stats().bad_lines + reader.stats().out_of_range + reader.stats().backward;
  if (count < kFewestSamples) {
    recording.refusal = "has " + std::to_string(count) + " samples; at least " + std::to_string(kFewestSamples) +
                        " are needed, hours are right";
    return recording;
  }
  recording.period_s = to_seconds(last - first) / static_cast<double>(count - 1 + recording.missing);
  return recording;
}

AllanResult evaluate(const RestRecording& recording) {
  AllanResult result;
  for (std::size_t i = 0; i < kAxes; ++i) {
    result[i].curve = allan_deviation(recording.axes[i], recording.period_s);
    result[i].figures = allan_figures(result[i].curve);
  }
  return result;
}

std::string allan_report(const RestRecording& recording, const AllanResult& result) {
  char line[160];
  const std::size_t count = recording.axes[0].size();
  std::snprintf(line, sizeof line, "%zu samples, %.1f s at %.3f Hz, %llu missing\n\n", count,
                static_cast<double>(count) * recording.period_s, 1.0 / recording.period_s,
                static_cast<unsigned long long>(recording.missing));
  std::string text = line;
  std::snprintf(line, sizeof line, "%-8s  %-22s  %-26s  %-20s\n", "axis", "noise density", "bias instability",
                "bias random walk");
  text += line;
  for (std::size_t i = 0; i < kAxes; ++i) {
    const AllanFigures& f = result[i].figures;
    const char* unit = i < 3 ? "rad/s" : "m/s^2";
    std::snprintf(line, sizeof line, "%-8s  %.3e %s/rtHz  %s%.3e %s at %.1f s  %.3e %s/s/rtHz\n", kAxisNames[i],
                  f.noise_density, unit, f.flat_is_reached ? "" : "<= ", f.bias_instability, unit, f.flat_tau_s,
                  f.random_walk, unit);
    text += line;
  }
  text += "\nfor slamd.yaml (the worst axis of each):\n\nodometry:\n  imu:\n";
  text += yaml_line("gyro_noise_rads_rthz", worst(result, 0, &AllanFigures::noise_density), "rad/s/rtHz");
  text += yaml_line("accel_noise_mps2_rthz", worst(result, 3, &AllanFigures::noise_density), "m/s^2/rtHz");
  text += yaml_line("gyro_bias_walk_rads2_rthz", worst(result, 0, &AllanFigures::random_walk), "rad/s^2/rtHz");
  text += yaml_line("accel_bias_walk_mps3_rthz", worst(result, 3, &AllanFigures::random_walk), "m/s^3/rtHz");
  return text;
}

}  // namespace slamd::monitor
