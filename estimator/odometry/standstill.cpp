#include "estimator/odometry/standstill.hpp"

#include <Eigen/Cholesky>

namespace slamd {

using I = ErrorIndex;

namespace {

constexpr double kMostGap_s = 0.05;  // between samples

/// Largest deviation of an axis over the samples from index `first` on.
double deviation(const ImuBuffer& samples, std::size_t first, std::size_t end, Eigen::Vector3d ImuSample::*value) {
  const auto count = static_cast<double>(end - first);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i < end; ++i) mean += samples[i].*value / count;
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i < end; ++i) variance += (samples[i].*value - mean).cwiseAbs2() / count;
  return std::sqrt(variance.maxCoeff());
}

}  // namespace

bool is_standing(const StandstillConfig& config, const ImuBuffer& samples, HostTime at) {
  const HostTime begin = at - from_seconds(config.window_s);
  const Duration most_gap = from_seconds(kMostGap_s);
  const std::size_t first = samples.first_after(begin);
  const std::size_t end = samples.first_after(at);
  if (first == end || samples[first].time - begin > most_gap || at - samples[end - 1].time > most_gap) return false;
  for (std::size_t i = first + 1; i < end; ++i) {
    if (samples[i].time - samples[i - 1].time > most_gap) return false;
  }
  return deviation(samples, first, end, &ImuSample::gyro_rads) < config.gyro_std_rads &&
         deviation(samples, first, end, &ImuSample::accel_mps2) < config.accel_std_mps2;
}

bool update_standstill(const StandstillConfig& config, FilterSnapshot& filter) {
  const Eigen::Vector3d velocity = filter.state.v_odom_imu;
  if (velocity.norm() > config.most_mps) return false;
  const Eigen::Matrix3d innovation = filter.covariance.block<3, 3>(I::kVelocity, I::kVelocity) +
                                     config.sigma_mps * config.sigma_mps * Eigen::Matrix3d::Identity();
  const Eigen::LLT<Eigen::Matrix3d> factor{innovation};
  if (velocity.dot(factor.solve(velocity)) > config.gate_sigmas * config.gate_sigmas) return false;
  const Eigen::Matrix<double, I::kSize, 3> gain = factor.solve(filter.covariance.middleRows<3>(I::kVelocity)).transpose();
  const CloneCovariance cross = filter.clone.cross - gain * filter.clone.cross.middleRows<3>(I::kVelocity);
  const ErrorCovariance covariance = filter.covariance - gain * filter.covariance.middleRows<3>(I::kVelocity);
  filter.state = boxplus(filter.state, -gain * velocity);
  filter.covariance = covariance;
  filter.clone.cross = cross;
  symmetrise(filter.covariance);
  return true;
}

}  // namespace slamd
