#include "estimator/filter/initialisation.hpp"

namespace slamd {

using I = ErrorIndex;

namespace {

constexpr double kMostForceError_mps2 = 1.0;  // at rest: LSM6DSOX offset and scale, all axes
constexpr double kLeastForce_mps2 = 3.0;      // less is no vehicle on the ground but a sensor that is stuck or falls
constexpr double kMotionLasts_s = 3.0;        // seen by an earlier run
constexpr double kSeenVelocity_mps = 0.5;     // sigma of its velocity, to begin with,
constexpr double kBrakes_mps2 = 2.0;          // growing by as much
constexpr double kSeenUp_mps2 = 0.5;          // of gravity: a road that tilts by 0.05 rad
constexpr double kTinyVariance = 1e-10;  // of pose: the first pose defines odom

double squared(double x) { return x * x; }

void set_variance(ErrorCovariance& p, int index, int size, double sigma) {
  p.diagonal().segment(index, size).setConstant(squared(sigma));
}

/// R_odom_imu with odom's z along `up_imu` and the base's x axis in odom's x-z plane.
Eigen::Quaterniond attitude_from_up(const Eigen::Vector3d& up_imu, const Pose& T_base_imu) {
  const Eigen::Vector3d up_base = T_base_imu.rotation * up_imu.normalized();
  const Eigen::Vector3d y = up_base.cross(Eigen::Vector3d::UnitX()).normalized();
  Eigen::Matrix3d R_odom_base;
  R_odom_base.row(0) = y.cross(up_base);
  R_odom_base.row(1) = y;
  R_odom_base.row(2) = up_base;
  return (Eigen::Quaterniond{R_odom_base} * T_base_imu.rotation).normalized();
}

/// The measured mean force is f = b_a - R^T g + noise, so an error of b_a along the horizon is one of gravity's direction.
void couple_gravity(const InertialState& state, double bias_sigma, double noise_sigma, ErrorCovariance& p) {
  const Matrix32d bias_by_gravity =
      -state.R_odom_imu.toRotationMatrix().transpose() * skew(state.gravity) * tangent_basis_s2(state.gravity);
  const Eigen::Matrix<double, 2, 3> gravity_by_bias =
      (bias_by_gravity.transpose() * bias_by_gravity).inverse() * bias_by_gravity.transpose();
  p.block<3, 3>(I::kAccelBias, I::kAccelBias) = squared(bias_sigma) * Eigen::Matrix3d::Identity();
  p.block<2, 2>(I::kGravity, I::kGravity) =
      (squared(bias_sigma) + squared(noise_sigma)) * gravity_by_bias * gravity_by_bias.transpose();
  p.block<2, 3>(I::kGravity, I::kAccelBias) = squared(bias_sigma) * gravity_by_bias;
  p.block<3, 2>(I::kAccelBias, I::kGravity) = p.block<2, 3>(I::kGravity, I::kAccelBias).transpose();
}

InertialState state_at(const Pose& T_odom_imu, const Pose& T_imu_lidar) {
  InertialState state;
  state.R_odom_imu = T_odom_imu.rotation;
  state.p_odom_imu = T_odom_imu.translation;
  state.T_imu_lidar = T_imu_lidar;
  return state;
}

ErrorCovariance first_covariance(double velocity, double gyro_bias) {
  ErrorCovariance p = ErrorCovariance::Zero();
  p.diagonal().head<6>().setConstant(kTinyVariance);
  set_variance(p, I::kVelocity, 3, velocity);
  set_variance(p, I::kGyroBias, 3, gyro_bias);
  return p;
}

}  // namespace

Pose level_pose(const Eigen::Vector3d& up_imu, const Pose& T_base_imu) {
  const Eigen::Quaterniond R_odom_imu = attitude_from_up(up_imu, T_base_imu);
  const Eigen::Quaterniond R_odom_base = R_odom_imu * T_base_imu.rotation.conjugate();
  return {R_odom_imu, R_odom_base * T_base_imu.translation};
}

void Initialisation::add(const ImuSample& sample) {
  if (count_ > 0 && sample.time <= reading(count_ - 1).time) clear();
  const auto drop_first = [this] {
    first_ = (first_ + 1) % kCapacity;
    --count_;
  };
  if (count_ == kCapacity) drop_first();
  window_[(first_ + count_) % kCapacity] = {sample.time, sample.gyro_rads, sample.accel_mps2};
  ++count_;
  while (count_ > 1 && sample.time - reading(1).time >= from_seconds(config_.rest_s)) drop_first();
}

Initialisation::Moments Initialisation::moments(Eigen::Vector3d Reading::*value) const {
  Moments out;
  const double share = 1.0 / static_cast<double>(count_);
  for (std::size_t i = 0; i < count_; ++i) out.mean += share * (reading(i).*value);
  for (std::size_t i = 0; i < count_; ++i) out.deviation += share * (reading(i).*value - out.mean).cwiseAbs2();
  out.deviation = out.deviation.cwiseSqrt();
  return out;
}

bool Initialisation::is_still(const Moments& gyro, const Moments& accel) const {
  return count_ > 1 && std::abs(accel.mean.norm() - kGravity_mps2) < kMostForceError_mps2 &&
         gyro.deviation.maxCoeff() < config_.still_gyro_std_rads && gyro.mean.norm() < config_.still_gyro_mean_rads &&
         accel.deviation.maxCoeff() < config_.still_accel_std_mps2;
}

bool Initialisation::is_still() const {
  return count_ > 1 && is_still(moments(&Reading::gyro_rads), moments(&Reading::accel_mps2));
}

bool Initialisation::is_ready() const {
  if (count_ == 0 || moments(&Reading::accel_mps2).mean.norm() < kLeastForce_mps2) return false;
  const double length_s = to_seconds(length());
  if (length_s >= config_.rest_s || count_ == kCapacity) return true;
  return length_s >= config_.min_s && !is_still();
}

InitialState Initialisation::state(HostTime time, const Pose& T_base_imu, const Pose& T_imu_lidar,
                                   bool with_extrinsic) const {
  InitialState out;
  const Moments gyro = moments(&Reading::gyro_rads);
  const Moments accel = moments(&Reading::accel_mps2);
  out.at_rest = is_still(gyro, accel);
  const Eigen::Vector3d force = accel.mean - config_.known_accel_bias_mps2;
  out.filter.time = time;
  InertialState& state = out.filter.state;
  state = state_at(level_pose(force, T_base_imu), T_imu_lidar);
  out.filter.covariance =
      out.at_rest ? first_covariance(config_.rest_velocity_mps, config_.rest_gyro_bias_rads)
                  : first_covariance(config_.moving_velocity_mps, config_.moving_gyro_bias_rads);
  state.gyro_bias = out.at_rest ? gyro.mean : config_.known_gyro_bias_rads;
  state.accel_bias = config_.known_accel_bias_mps2;
  if (out.at_rest) state.accel_bias += force - kGravity_mps2 * force.normalized();
  couple_gravity(state, config_.accel_bias_mps2,
                 out.at_rest ? config_.rest_accel_noise_mps2 : config_.moving_accel_noise_mps2, out.filter.covariance);
  const std::optional<double> age_s = motion_age_s(time);
  if (!out.at_rest && age_s) go_on(*age_s, T_base_imu, out);
  if (with_extrinsic) {
    set_variance(out.filter.covariance, I::kExtrinsicRotation, 3, config_.extrinsic_rotation_rad);
    set_variance(out.filter.covariance, I::kExtrinsicTranslation, 3, config_.extrinsic_translation_m);
  }
  return out;
}

std::optional<double> Initialisation::motion_age_s(HostTime time) const {
  const KnownMotion& seen = config_.known_motion;
  const double age_s = to_seconds(time.time_since_epoch()) - seen.at_s;
  const bool known = seen.at_s > 0.0 && seen.up.norm() > 0.5;
  return known && age_s >= 0.0 && age_s < kMotionLasts_s ? std::optional{age_s} : std::nullopt;
}

/// Up from where it was: what the accelerometer tells of it while the vehicle brakes or turns is worse.
void Initialisation::go_on(double age_s, const Pose& T_base_imu, InitialState& out) const {
  const KnownMotion& seen = config_.known_motion;
  InertialState& state = out.filter.state;
  const Pose T_odom_imu = level_pose(T_base_imu.rotation.conjugate() * seen.up, T_base_imu);
  state.R_odom_imu = T_odom_imu.rotation;
  state.p_odom_imu = T_odom_imu.translation;
  state.v_odom_imu = T_odom_imu.rotation * T_base_imu.rotation.conjugate() * seen.velocity_mps;
  out.filter.covariance = first_covariance(kSeenVelocity_mps + kBrakes_mps2 * age_s, config_.rest_gyro_bias_rads);
  couple_gravity(state, config_.accel_bias_mps2, kSeenUp_mps2, out.filter.covariance);
  out.motion_known = true;
}

InitialState initial_state_without_imu(HostTime time, const InitialisationConfig& config, const Pose& T_base_imu,
                                       const Pose& T_imu_lidar) {
  InitialState out;
  out.with_imu = false;
  out.filter.time = time;
  out.filter.state = state_at(T_base_imu, T_imu_lidar);
  out.filter.covariance = first_covariance(config.moving_velocity_mps, config.moving_gyro_bias_rads);
  couple_gravity(out.filter.state, config.accel_bias_mps2, config.moving_accel_noise_mps2, out.filter.covariance);
  return out;
}

}  // namespace slamd
