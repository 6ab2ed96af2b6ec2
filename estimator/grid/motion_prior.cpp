#include "estimator/grid/motion_prior.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "estimator/grid/planar_covariance.hpp"

namespace slamd {
namespace {

constexpr double kKept_s = 3.0;            // of wheels and turns
constexpr double kWheelGap_s = 0.5;        // longer between two of them: nothing is known of the time between
constexpr double kTurnGap_s = 0.1;
constexpr double kVelocityShare = 0.8;     // of a measured velocity that is believed
constexpr double kBiasWalk_rads_rts = 1e-5;
constexpr double kLeastStep_s = 0.02;      // shorter between two scans: stamps say nothing of the velocity
constexpr double kScanTurn_rad = 0.002;     // by which two scans err
constexpr int kKnots = 21;

template <class Samples>
void forget(Samples& samples) {
  while (samples.size() > 2 && samples.back().time - samples.front().time > from_seconds(kKept_s)) samples.pop_front();
}

PlanarPose pose_of(const WheelOdometry& wheels) { return {{wheels.x_m, wheels.y_m}, wheels.yaw_rad}; }

/// Of the way from a to b; beyond them at most as far again, for two stamps may be next to each other.
double share_of(HostTime time, HostTime a, HostTime b) {
  return std::clamp(to_seconds(time - a) / to_seconds(b - a), -1.0, 2.0);
}

/// The neighbours of an instant, for inter- or extrapolation; nullopt where both are farther than gap_s.
template <class Samples>
std::optional<std::size_t> neighbour(const Samples& samples, HostTime time, double gap_s) {
  if (samples.size() < 2) return std::nullopt;
  const auto after = std::ranges::lower_bound(samples, time, {}, [](const auto& s) { return s.time; });
  const auto index = static_cast<std::size_t>(after - samples.begin());
  const std::size_t i = std::clamp<std::size_t>(index, 1, samples.size() - 1) - 1;
  const Duration gap = from_seconds(gap_s);
  const Duration off = std::min(std::chrono::abs(time - samples[i].time), std::chrono::abs(time - samples[i + 1].time));
  if (off > gap) return std::nullopt;
  return i;
}

}  // namespace

void MotionPrior::add(const WheelOdometry& wheels) {
  if (!std::isfinite(wheels.x_m) || !std::isfinite(wheels.y_m) || !std::isfinite(wheels.yaw_rad)) return;
  if (!wheels_.empty() && wheels.time <= wheels_.back().time) return;
  wheels_.push_back(wheels);
  forget(wheels_);
}

void MotionPrior::add_turn(HostTime time, double yaw_rate_rads) {
  if (!turns_.empty() && time <= turns_.back().time) return;
  double yaw = 0.0;
  if (!turns_.empty()) {
    const Turn& last = turns_.back();
    yaw = last.yaw_rad + 0.5 * (last.rate_rads + yaw_rate_rads) * to_seconds(time - last.time);
  }
  turns_.push_back({time, yaw, yaw_rate_rads});
  forget(turns_);
}

std::optional<double> MotionPrior::turned(HostTime time) const {
  const std::optional<std::size_t> i = neighbour(turns_, time, kTurnGap_s);
  if (!i) return std::nullopt;
  const Turn& a = turns_[*i];
  const Turn& b = turns_[*i + 1];
  const double share = share_of(time, a.time, b.time);
  return a.yaw_rad + share * (b.yaw_rad - a.yaw_rad);
}

std::optional<PlanarPose> MotionPrior::wheels_at(HostTime time) const {
  const std::optional<std::size_t> i = neighbour(wheels_, time, kWheelGap_s);
  if (!i) return std::nullopt;
  const WheelOdometry& a = wheels_[*i];
  const WheelOdometry& b = wheels_[*i + 1];
  const double share = share_of(time, a.time, b.time);
  return GroupSe2::plus(pose_of(a), share * GroupSe2::minus(pose_of(b), pose_of(a)));
}

/// From the newest estimate to an instant.
PlanarPose MotionPrior::relative(HostTime time) const {
  const double dt = to_seconds(time - time_);
  const std::optional<double> turned_then = turned(time_);
  const std::optional<double> turned_now = turned(time);
  const std::optional<PlanarPose> wheels_then = wheels_at(time_);
  const std::optional<PlanarPose> wheels_now = wheels_at(time);
  PlanarPose way;
  way.yaw_rad = velocity_[2] * dt;
  if (wheels_then && wheels_now) way = wheels_then->inverse() * *wheels_now;
  if (turned_then && turned_now) way.yaw_rad = *turned_now - *turned_then - bias_rads_ * dt;
  if (!(wheels_then && wheels_now)) {
    way.translation = Eigen::Rotation2Dd{0.5 * way.yaw_rad} * Eigen::Vector2d{velocity_.head<2>() * dt};
  }
  return way;
}

/// What the way since the newest estimate adds to its covariance.
Eigen::Matrix3d MotionPrior::noise(HostTime end, const PlanarPose& way) const {
  const double dt = std::abs(to_seconds(end - time_));
  const double length = way.translation.norm();
  const bool has_wheels = wheels_at(time_) && wheels_at(end);
  double sigma_m = has_wheels ? config_.wheel_slip * length : 0.5 * config_.accel_mps2 * dt * dt + 0.05 * length;
  if (!knows_velocity()) sigma_m = config_.start_mps * dt;
  double sigma_rad = 0.5 * config_.turn_accel_rads2 * dt * dt;
  if (has_wheels) sigma_rad = std::hypot(config_.wheel_turn_slip * wrap_angle(way.yaw_rad), config_.wheel_turn_rad_m * length);
  const bool has_gyro = turned(time_) && turned(end);
  if (has_gyro) sigma_rad = std::hypot(config_.gyro_rads, bias_sigma_rads_) * dt;
  sigma_m = std::hypot(sigma_m, config_.least_sigma_m);
  sigma_rad = std::hypot(sigma_rad, has_gyro ? config_.gyro_least_sigma_rad : config_.least_sigma_rad);
  return Eigen::Vector3d{sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad}.asDiagonal();
}

MotionPrior::Prediction MotionPrior::predict(HostTime begin, HostTime end) const {
  Prediction prediction;
  const double span_s = to_seconds(end - begin);
  const int knots = span_s > 0.0 ? kKnots : 1;
  const double step_s = knots > 1 ? span_s / (knots - 1) : 0.0;
  std::vector<PlanarPose> poses;
  for (int i = 0; i < knots; ++i) poses.push_back(T_odom_base_ * relative(begin + from_seconds(i * step_s)));
  const PlanarPose way = relative(end);
  poses.back() = T_odom_base_ * way;
  const Eigen::Matrix3d ad = planar_adjoint(way.inverse());
  prediction.prior = {poses.back(), (ad * covariance_ * ad.transpose() + noise(end, way)).inverse()};
  prediction.motion.assign(-span_s, step_s, poses);
  prediction.from_s = to_seconds(end - time_);
  return prediction;
}

/// The gyro's bias is what it turned more than the scans say; a scalar Kalman filter.
void MotionPrior::learn_bias(HostTime time, const PlanarPose& T_odom_base) {
  const std::optional<double> then = turned(time_);
  const std::optional<double> now = turned(time);
  const double dt = to_seconds(time - time_);
  if (!then || !now || dt <= 0.0) return;
  const double measured = (*now - *then - wrap_angle(T_odom_base.yaw_rad - T_odom_base_.yaw_rad)) / dt;
  const double noise = kScanTurn_rad / dt;
  const double variance = bias_sigma_rads_ * bias_sigma_rads_ + kBiasWalk_rads_rts * kBiasWalk_rads_rts * dt;
  const double gain = variance / (variance + noise * noise);
  if (std::abs(measured - bias_rads_) > 5.0 * std::hypot(noise, bias_sigma_rads_)) return;
  bias_rads_ += gain * (measured - bias_rads_);
  bias_sigma_rads_ = std::sqrt((1.0 - gain) * variance);
}

void MotionPrior::estimate(HostTime time, const PlanarPose& T_odom_base, const Eigen::Matrix3d& covariance, bool is_measured) {
  const double dt = to_seconds(time - time_);
  if (is_measured && has_estimate() && dt > kLeastStep_s) {
    learn_bias(time, T_odom_base);
    GroupSe2::Tangent way = GroupSe2::minus(T_odom_base, T_odom_base_);
    way.head<2>() = Eigen::Rotation2Dd{-0.5 * way[2]} * Eigen::Vector2d{way.head<2>()};
    velocity_ += (measured_ == 0 ? 1.0 : kVelocityShare) * (way / dt - velocity_);
    measured_ = std::min(measured_ + 1, kVelocityScans);
  }
  time_ = time;
  T_odom_base_ = T_odom_base;
  covariance_ = covariance;
}

}  // namespace slamd
