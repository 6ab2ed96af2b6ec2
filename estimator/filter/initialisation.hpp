#pragma once
// The filter's first state from the moments of IMU data before it, at rest or moving. No map, no scan.

#include <array>
#include <optional>

#include "estimator/filter/inertial_state.hpp"
#include "estimator/types/imu_sample.hpp"

namespace slamd {

inline constexpr double kMostKnownBias = 1.0;  // rad/s and m/s^2, an axis: beyond it the sensor is broken

/// How the vehicle moved when an earlier run saw it last.
struct KnownMotion {
  double at_s = 0.0;                                       // host clock; 0: nothing is known
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();  // of base, in base
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();           // unit, against gravity, in base
};

struct InitialisationConfig {
  double rest_s = 0.8;                       // of stillness make a start at rest
  double min_s = 0.3;                        // of any data make a start while moving
  double still_gyro_std_rads = 0.01;         // of every axis, over the window
  double still_gyro_mean_rads = 0.06;        // LSM6DSOX zero-rate level: 0.017 typical
  double still_accel_std_mps2 = 0.15;
  // Standard deviations of the first state.
  double rest_velocity_mps = 0.5;            // even at rest: smooth motion looks like rest to an IMU
  double moving_velocity_mps = 8.0;
  double rest_gyro_bias_rads = 3.0e-4;
  double moving_gyro_bias_rads = 0.02;
  double accel_bias_mps2 = 0.15;             // LSM6DSOX zero-g level: 0.2 at most over life
  double rest_accel_noise_mps2 = 0.02;       // of the window's mean
  double moving_accel_noise_mps2 = 1.0;      // true acceleration taken for gravity
  // Biases as they are known before the start, imu frame: calibrated, or left by an earlier run. As unsure as said above.
  Eigen::Vector3d known_gyro_bias_rads = Eigen::Vector3d::Zero();
  Eigen::Vector3d known_accel_bias_mps2 = Eigen::Vector3d::Zero();
  KnownMotion known_motion;                  // for a start while moving, some seconds after
  double extrinsic_rotation_rad = 0.01;      // used when the extrinsic is estimated
  double extrinsic_translation_m = 0.03;
};

struct InitialState {
  FilterSnapshot filter;   // base at the origin of odom, odom's z up, yaw zero
  bool at_rest = false;
  bool with_imu = true;
  bool motion_known = false;  // velocity and up are those of an earlier run, carried on
};

/// Watches the newest rest_s of samples and says when they suffice: what happened before does not matter.
class Initialisation {
 public:
  explicit Initialisation(const InitialisationConfig& config) : config_{config} {}

  /// Samples in order of time; one that is not younger than the newest starts anew. No allocation.
  void add(const ImuSample& sample);
  void clear() { first_ = count_ = 0; }
  /// Stillness is broken or has lasted for the whole window, so that state() may be asked for. Never while the mean force is
  /// too small to tell where down is. Cost: one pass over the window, as for the next two.
  bool is_ready() const;
  bool is_still() const;
  /// The state at `time`: gravity from the mean specific force, or moving as it is known, gyro bias from the mean rate when at rest. Accelerometer
  /// bias and gravity direction are correlated as the measurement demands. Not on an empty window.
  InitialState state(HostTime time, const Pose& T_base_imu, const Pose& T_imu_lidar, bool with_extrinsic) const;

 private:
  static constexpr std::size_t kCapacity = 1'024;  // 5 s at 200 Hz: bounds the window where rest_s does not

  struct Reading {
    HostTime time;
    Eigen::Vector3d gyro_rads, accel_mps2;
  };
  struct Moments {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Vector3d deviation = Eigen::Vector3d::Zero();
  };

  const Reading& reading(std::size_t i) const { return window_[(first_ + i) % kCapacity]; }
  Duration length() const { return reading(count_ - 1).time - reading(0).time; }
  Moments moments(Eigen::Vector3d Reading::*value) const;
  bool is_still(const Moments& gyro, const Moments& accel) const;
  /// Seconds since the motion of an earlier run was seen; none: too long ago to say anything now.
  std::optional<double> motion_age_s(HostTime time) const;
  void go_on(double age_s, const Pose& T_base_imu, InitialState& out) const;

  InitialisationConfig config_;
  std::array<Reading, kCapacity> window_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

/// Of the IMU when base is at the origin of odom, odom's z along up_imu (any length) and yaw zero.
Pose level_pose(const Eigen::Vector3d& up_imu, const Pose& T_base_imu);

/// The state when there is no IMU at all: level, at rest, everything uncertain.
InitialState initial_state_without_imu(HostTime time, const InitialisationConfig& config, const Pose& T_base_imu,
                                       const Pose& T_imu_lidar);

}  // namespace slamd
