#include "estimator/odometry/map_drift.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace slamd {

using I = ErrorIndex;

namespace {

double squared(double x) { return x * x; }

}  // namespace

Matrix6d first_drift(const MapDriftConfig& config) {
  Matrix6d drift = Matrix6d::Zero();
  drift.diagonal() << Eigen::Vector3d::Constant(squared(config.first_position_m)), squared(config.first_tilt_rad),
      squared(config.first_tilt_rad), squared(config.first_heading_rad);
  return drift;
}

Matrix6d skew_drift(const MapDriftConfig& config, const FilterSnapshot& filter) {
  const double velocity = filter.covariance.block<3, 3>(I::kVelocity, I::kVelocity).trace() / 3.0 +
                          squared(config.moving_velocity_share) * filter.state.v_odom_imu.squaredNorm();
  const double rate = filter.covariance.block<3, 3>(I::kGyroBias, I::kGyroBias).trace() / 3.0;
  const double displaced = squared(config.moving_skew_s) * velocity;
  const double turned = squared(config.moving_skew_s) * rate + displaced / squared(config.moving_lever_m);
  Matrix6d drift = Matrix6d::Zero();
  drift.diagonal() << Eigen::Vector3d::Constant(displaced), Eigen::Vector3d::Constant(turned);
  return drift;
}

Matrix6d lasting_part(const MapDriftConfig& config, const Matrix6d& step) {
  Eigen::Matrix<double, 6, 1> held;
  held << Eigen::Vector3d::Constant(config.held_position_m), Eigen::Vector3d::Constant(config.held_attitude_rad);
  const Matrix6d in_sigmas = held.cwiseInverse().asDiagonal() * step * held.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver{in_sigmas};
  const Eigen::Matrix<double, 6, 1> beyond = (solver.eigenvalues().array() - 1.0).cwiseMax(0.0);
  const Matrix6d lasting = solver.eigenvectors() * beyond.asDiagonal() * solver.eigenvectors().transpose();
  return held.asDiagonal() * lasting * held.asDiagonal();
}

Matrix6d carry_drift(const MapDriftConfig& config, const Matrix6d& drift, const Pose& T_odom_a, const Pose& T_odom_b,
                     const Matrix6d& local) {
  const Eigen::Vector3d moved = T_odom_b.translation - T_odom_a.translation;
  Matrix6d J_b_a = Matrix6d::Identity();
  J_b_a.block<3, 3>(0, 3) = -skew(moved) * T_odom_a.rotation.toRotationMatrix();
  J_b_a.block<3, 3>(3, 3) = (T_odom_b.rotation.conjugate() * T_odom_a.rotation).toRotationMatrix();
  Matrix6d out = J_b_a * drift * J_b_a.transpose();
  const double distance_m = moved.norm();
  out.diagonal().head<3>().array() += config.position_m_rtm * config.position_m_rtm * distance_m;
  out.diagonal().tail<3>().array() += config.attitude_rad_rtm * config.attitude_rad_rtm * distance_m;
  out += std::min(1.0, distance_m / config.renewal_m) * local;
  symmetrise(out);
  return out;
}

}  // namespace slamd
