#pragma once
// Odometry of two driven wheels on one axle, as lines of drivers/wheel: true motion in, sentences with slip and scale errors out.

#include <optional>

#include "tools/slam-sim/motion/trajectory.hpp"
#include "tools/slam-sim/sensors/sensor_clock.hpp"
#include "tools/slam-sim/sensors/wire_event.hpp"
#include "tools/slam-sim/world/rng.hpp"

namespace slamd::sim {

/// Defaults: rear axle of the reference vehicle. Errors of a calibrated vehicle; own choice.
struct WheelModel {
  double rate_hz = 50.0;
  double track_m = 1.6;           // between the wheels
  double tick_m = 0.01;           // of way a count
  double scale_percent = 0.3;     // error of both wheels' size, standard deviation
  double balance_percent = 0.03;  // of one against the other
  double track_percent = 0.3;     // of the track as it is told
  double slip_m_rtm = 0.002;      // slip of each wheel by itself, m per root metre
  double clock_skew_ppm = 40.0;
  double latency_min_s = 0.001;
  double latency_jitter_s = 0.003;  // uniform, on top
};

class WheelSensor {
 public:
  WheelSensor(const WheelModel& model, const Trajectory& trajectory, SensorClock clock, std::uint64_t seed);

  /// The next sentence whose counts were read before `until` (seconds); in order.
  std::optional<WireEvent> next(double until);

 private:
  struct Wheel {
    double scale;
    double way_m = 0.0;      // as turned
    double counted_m = 0.0;  // as counted
  };
  void roll(double from, double to);
  /// Metres since the last call, in whole counts.
  double count(Wheel& wheel) const;

  WheelModel model_;
  const Trajectory& trajectory_;
  SensorClock clock_;
  Rng rng_;
  Wheel left_, right_;
  double told_track_m_;
  double x_m_ = 0.0, y_m_ = 0.0, yaw_rad_ = 0.0;
  std::int64_t sentences_ = 0;
};

}  // namespace slamd::sim
