#include "estimator/grid/tilt.hpp"

#include <algorithm>

#include "estimator/math/lie.hpp"

namespace slamd {
namespace {

constexpr double kGravity_mps2 = 9.80665;
constexpr double kLongestStep_s = 0.1;  // after a longer gap the gyro says nothing of it

}  // namespace

void Tilt::add(const ImuSample& sample, double speed_mps) {
  const double dt = last_ == HostTime{} ? 0.0 : std::clamp(to_seconds(sample.time - last_), 0.0, kLongestStep_s);
  last_ = sample.time;
  if (!sample.gyro_rads.allFinite() || !sample.accel_mps2.allFinite()) return;
  const Eigen::Vector3d rate = R_base_imu_ * sample.gyro_rads;
  const Eigen::Vector3d turning = rate.cross(Eigen::Vector3d{speed_mps, 0.0, 0.0});
  const Eigen::Vector3d force = R_base_imu_ * sample.accel_mps2 - turning;
  if (!is_known()) {
    count_s_ += dt;
    force_sum_ += force;
    up_ = force_sum_.norm() > 1.0 ? Eigen::Vector3d{force_sum_.normalized()} : Eigen::Vector3d::UnitZ();
    yaw_rate_ = up_.dot(rate);
    return;
  }
  const Eigen::Vector3d turned = (rate - bias_rads_) * dt;
  up_ = (exp_so3(turned).conjugate() * up_).normalized();
  if (std::abs(force.norm() - kGravity_mps2) < config_.most_force_error_mps2) {
    const Eigen::Vector3d error = up_.cross(force.normalized());  // turn that brings up to the force
    const double gain = dt / config_.correction_s;
    up_ = (exp_so3(gain * error) * up_).normalized();
    bias_rads_ += 0.1 * gain / config_.correction_s * (error - up_ * up_.dot(error));
  }
  yaw_rate_ = up_.dot(rate);
}

}  // namespace slamd
