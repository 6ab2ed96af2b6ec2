#pragma once
// An LSM6DSOX behind its firmware: true motion in, wire frames out. Nothing is sent here.

#include <optional>

#include "estimator/types/pose.hpp"
#include "tools/slam-sim/motion/trajectory.hpp"
#include "tools/slam-sim/sensors/sensor_clock.hpp"
#include "tools/slam-sim/sensors/wire_event.hpp"
#include "tools/slam-sim/world/rng.hpp"

namespace slamd::sim {

/// Typical figures of the LSM6DSOX data sheet (DS12814, table 3); biases as after a factory trim.
struct ImuModel {
  double rate_hz = 200.0;
  double gyro_noise_mdps_rthz = 3.8;
  double accel_noise_ug_rthz = 70.0;
  double gyro_bias_dps = 0.3;  // turn-on, standard deviation per axis
  double accel_bias_mg = 8.0;
  double gyro_walk_mdps_rts = 1.0;  // random walk of the bias, mdps per root second
  double accel_walk_ug_rts = 20.0;
  double clock_skew_ppm = 25.0;
  double latency_min_s = 0.0003;     // read-out and USB
  double latency_jitter_s = 0.0017;  // uniform, on top
  double gravity_mps2 = 9.80665;
  double gyro_scale_percent = 0.0;  // error of scale, standard deviation per axis
  double engine_mps2 = 0.0;         // amplitude of an idling engine's shaking, each axis
  bool ideal = false;               // no noise, no bias
};

/// In the IMU's axes at its own place.
struct Inertial {
  Eigen::Vector3d rate_rads;
  Eigen::Vector3d specific_force_mps2;
};

/// Exact, at one instant. gravity_mps2 along world -z.
Inertial inertial_at(const Motion& motion, const Pose& T_base_imu, double gravity_mps2);

class ImuSensor {
 public:
  ImuSensor(const ImuModel& model, const Trajectory& trajectory, const Pose& T_base_imu, SensorClock clock,
            std::uint64_t seed);

  /// What it measures at one instant, before any wire.
  struct Measured {
    double t;
    std::uint32_t count;  // of the samples before
    double delay_s;       // until the host has it
    Inertial sensed;
  };

  /// The next sample taken before `until` (seconds); samples come in order.
  std::optional<Measured> measure(double until);
  /// The same as a frame of our firmware.
  std::optional<WireEvent> next(double until);

 private:
  Inertial low_passed(double t) const;
  Inertial with_errors(Inertial truth, double t);

  ImuModel model_;
  const Trajectory& trajectory_;
  Pose T_base_imu_;
  SensorClock clock_;
  Rng rng_;
  Eigen::Vector3d gyro_bias_, accel_bias_, gyro_scale_;
  std::int64_t count_ = 0;
};

}  // namespace slamd::sim
