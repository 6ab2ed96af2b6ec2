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

/// Covariance after the interval that starts at `state`: F P F^T + Q, only the blocks that F moves are touched.
/// Source: Xu et al. 2022, eq. (8); F is checked against finite differences in tests/estimator/imu_propagation_test.cpp.
void propagate_covariance(const InertialState& state, const ImuInterval& interval, const ImuNoise& noise,
                          ErrorCovariance& covariance);

/// The same for an interval in which nothing was measured and velocity and body rate are taken as constant: biases and
/// gravity have no part in it and learn nothing. gyro_rads of the interval is the body rate, its accel is not used.
void coast_covariance(const ImuInterval& interval, const ImuNoise& noise, ErrorCovariance& covariance);

/// d(error after)/d(error before): for tests and for relative covariances.
ErrorCovariance transition(const InertialState& state, const ImuInterval& interval);

}  // namespace slamd
