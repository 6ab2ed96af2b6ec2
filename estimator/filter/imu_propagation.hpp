#pragma once
// Moves state and covariance over one IMU interval. Knows nothing of scans, buffers or gaps: the caller splits those.

#include "estimator/filter/inertial_state.hpp"

namespace slamd {

/// Continuous-time white noise densities of the IMU and random walks of its biases.
struct ImuNoise {
  double gyro_noise_rads_rthz = 4.0e-4;        // LSM6DSOX 6.6e-5, rest: aliasing of vibration
  double accel_noise_mps2_rthz = 3.0e-3;       // LSM6DSOX 6.9e-4, rest likewise
  double gyro_bias_walk_rads2_rthz = 1.0e-5;
  double accel_bias_walk_mps3_rthz = 2.0e-4;
};

/// Mean angular rate and specific force of one interval, imu frame, biases included.
struct ImuInterval {
  Duration length{};
  Eigen::Vector3d gyro_rads;
  Eigen::Vector3d accel_mps2;
};

/// State after the interval: constant rate and specific force in it, rotation of the force at mid-interval.
/// Source: Xu et al. 2022, eq. (7), with the mid-point in place of the Euler step.
InertialState propagate(const InertialState& state, const ImuInterval& interval);

/// d(error after)/d(error before) over the interval that starts at `state`; differs from the identity in the rows of
/// attitude, position and velocity only.
/// Source: Xu et al. 2022, eq. (7); checked against finite differences in tests/estimator/imu_propagation_test.cpp.
ErrorCovariance transition(const InertialState& state, const ImuInterval& interval);

/// The same for an interval in which nothing was measured and velocity and body rate are taken as constant: biases and
/// gravity have no part in it and learn nothing.
ErrorCovariance coast_transition(Duration length, const Eigen::Vector3d& angular_velocity_rads);

/// F P F^T + Q over dt_s, for an F of transition() or coast_transition(). Source: Xu et al. 2022, eq. (8).
void propagate_covariance(const ErrorCovariance& F, const ImuNoise& noise, double dt_s, ErrorCovariance& covariance);

/// F X: what the moved state still shares with a clone, which does not move.
void propagate_cross(const ErrorCovariance& F, CloneCovariance& cross);

}  // namespace slamd
