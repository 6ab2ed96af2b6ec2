#pragma once
// Random filter states, errors and covariances, and central differences, for the tests of the estimator. No assertions.

#include <random>

#include "estimator/filter/inertial_state.hpp"

namespace slamd::test {

using Random = std::mt19937_64;

inline double normal(Random& random, double sigma = 1.0) { return std::normal_distribution<double>{0.0, sigma}(random); }
inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>{low, high}(random);
}

inline Eigen::Vector3d normal3(Random& random, double sigma = 1.0) {
  const double x = normal(random, sigma);
  const double y = normal(random, sigma);
  return {x, y, normal(random, sigma)};
}

inline Eigen::Vector3d unit3(Random& random) { return normal3(random).normalized(); }

inline Eigen::Quaterniond random_rotation(Random& random) { return exp_so3(uniform(random, 0.0, 3.1) * unit3(random)); }

inline Pose random_pose(Random& random, double extent_m = 2.0) {
  const Eigen::Quaterniond rotation = random_rotation(random);
  return {rotation, normal3(random, extent_m)};
}

/// Any attitude, gravity within some tens of degrees of -z, as odom's definition has it.
inline InertialState random_state(Random& random) {
  InertialState state;
  state.R_odom_imu = random_rotation(random);
  state.p_odom_imu = normal3(random, 20.0);
  state.v_odom_imu = normal3(random, 5.0);
  state.gyro_bias = normal3(random, 0.05);
  state.accel_bias = normal3(random, 0.3);
  const double tilt_x = normal(random, 0.2);
  state.gravity = boxplus_s2(state.gravity, {tilt_x, normal(random, 0.2)});
  state.T_imu_lidar = random_pose(random, 0.5);
  return state;
}

inline ErrorVector random_error(Random& random, double sigma) {
  ErrorVector e;
  for (int i = 0; i < ErrorIndex::kSize; ++i) e[i] = normal(random, sigma);
  return e;
}

/// Symmetric and positive definite, eigenvalues about sigma^2.
inline ErrorCovariance random_covariance(Random& random, double sigma) {
  ErrorCovariance root;
  for (int i = 0; i < root.size(); ++i) root(i) = normal(random, sigma / 5.0);
  return root * root.transpose() + 0.1 * sigma * sigma * ErrorCovariance::Identity();
}

/// d f / d x at zero by central differences; f takes a vector of kIn and returns one of kOut.
template <int kOut, int kIn, class Function>
Eigen::Matrix<double, kOut, kIn> central_differences(const Function& f, double step = 1e-5) {
  Eigen::Matrix<double, kOut, kIn> jacobian;
  for (int i = 0; i < kIn; ++i) {
    Eigen::Matrix<double, kIn, 1> d = Eigen::Matrix<double, kIn, 1>::Zero();
    d[i] = step;
    const Eigen::Matrix<double, kOut, 1> forward = f(d);
    const Eigen::Matrix<double, kOut, 1> backward = f(-d);
    jacobian.col(i) = (forward - backward) / (2.0 * step);
  }
  return jacobian;
}

}  // namespace slamd::test
