#pragma once
// The filter's first state from the first moments of IMU data, at rest or moving. No map, no scan.

#include "estimator/filter/inertial_state.hpp"
#include "estimator/types/imu_sample.hpp"

namespace slamd {

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
  double extrinsic_rotation_rad = 0.01;      // used when the extrinsic is estimated
  double extrinsic_translation_m = 0.03;
};

struct InitialState {
  FilterSnapshot filter;   // base at the origin of odom, odom's z up, yaw zero
  bool at_rest = false;
};

/// Collects samples in order of time and says when they suffice.
class Initialisation {
 public:
  explicit Initialisation(const InitialisationConfig& config) : config_{config} {}

  void add(const ImuSample& sample);
  void clear();
  /// Stillness is broken or has lasted long enough, so that state() may be asked for. Never while the mean force is too
  /// small to tell where down is.
  bool is_ready() const;
  bool is_still() const;
  /// The state at `time`: gravity from the mean specific force, gyro bias from the mean rate when at rest. Accelerometer
  /// bias and gravity direction are correlated as the measurement demands.
  InitialState state(HostTime time, const Pose& T_base_imu, const Pose& T_imu_lidar, bool with_extrinsic) const;

 private:
  struct Sums {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Vector3d square = Eigen::Vector3d::Zero();
    Eigen::Vector3d mean(double n) const { return sum / n; }
    Eigen::Vector3d deviation(double n) const {
      return (square / n - mean(n).cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
    }
  };
  InitialisationConfig config_;
  Sums gyro_, accel_;
  double count_ = 0.0;
  HostTime first_, last_;
};

/// The state when there is no IMU at all: level, at rest, everything uncertain.
InitialState initial_state_without_imu(HostTime time, const InitialisationConfig& config, const Pose& T_base_imu,
                                       const Pose& T_imu_lidar);

}  // namespace slamd
