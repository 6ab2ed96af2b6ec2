#include "tools/slam-sim/sensors/imu_sensor.hpp"

#include <cmath>
#include <numbers>

#include "firmware/protocol/imu_frame.hpp"

namespace slamd::sim {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.80665;
constexpr double kRadPerMdps = std::numbers::pi / 180.0 * 1e-3;
constexpr double kMps2PerMg = kGravity * 1e-3;
constexpr std::array<double, 4> kFilterTaps{-0.375, -0.125, 0.125, 0.375};  // of a sample period: a symmetric average

Vector3d normal3(Rng& rng) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return {x, y, z};
}

struct Quantised {
  std::array<std::int16_t, 3> counts;
  bool clipped;
};

Quantised quantise(const Vector3d& value, double unit) {
  Quantised out{{}, false};
  for (std::size_t i = 0; i < 3; ++i) {
    const double counts = std::round(value[static_cast<Eigen::Index>(i)] / unit);
    out.clipped = out.clipped || counts > 32767.0 || counts < -32768.0;
    out.counts[i] = static_cast<std::int16_t>(std::clamp(counts, -32768.0, 32767.0));
  }
  return out;
}

/// Four cylinders at 800 revolutions per minute; each axis in a phase of its own.
Vector3d engine_shaking(double t) {
  constexpr double kEngineHz = 26.67;
  const Vector3d phase(2 * std::numbers::pi * kEngineHz * t + 1.0, 2 * std::numbers::pi * kEngineHz * t + 3.0,
                       2 * std::numbers::pi * kEngineHz * t + 5.0);
  return phase.array().sin();
}

}  // namespace

Inertial inertial_at(const Motion& motion, const Pose& T_base_imu, double gravity_mps2) {
  const Vector3d& arm = T_base_imu.translation;
  const Vector3d& w = motion.rate;
  const Vector3d swing = motion.rate_change.cross(arm) + w.cross(w.cross(arm));
  const Vector3d up = motion.acceleration + gravity_mps2 * Vector3d::UnitZ();
  const Eigen::Quaterniond R_imu_base = T_base_imu.rotation.conjugate();
  return {R_imu_base * w, R_imu_base * (motion.T_world_base.rotation.conjugate() * up + swing)};
}

ImuSensor::ImuSensor(const ImuModel& model, const Trajectory& trajectory, const Pose& T_base_imu, SensorClock clock,
                     std::uint64_t seed)
    : model_{model},
      trajectory_{trajectory},
      T_base_imu_{T_base_imu},
      clock_{std::move(clock)},
      rng_{seed, Stream::kImu} {
  Rng unit{seed, Stream::kImuUnit};
  gyro_bias_ = normal3(unit) * (model.gyro_bias_dps * 1e3 * kRadPerMdps);
  accel_bias_ = normal3(unit) * (model.accel_bias_mg * kMps2PerMg);
  gyro_scale_ = Vector3d::Ones() + normal3(unit) * (model.gyro_scale_percent * 0.01);
}

Inertial ImuSensor::low_passed(double t) const {
  Inertial mean{Vector3d::Zero(), Vector3d::Zero()};
  for (const double tap : kFilterTaps) {
    const Inertial now =
        inertial_at(trajectory_.at(std::max(0.0, t + tap / model_.rate_hz)), T_base_imu_, model_.gravity_mps2);
    mean.rate_rads += now.rate_rads / kFilterTaps.size();
    mean.specific_force_mps2 += now.specific_force_mps2 / kFilterTaps.size();
  }
  return mean;
}

Inertial ImuSensor::with_errors(Inertial truth, double t) {
  if (model_.ideal) return truth;
  const double root_rate = std::sqrt(0.5 * model_.rate_hz);  // density times the root of the noise bandwidth
  const double root_period = std::sqrt(1.0 / model_.rate_hz);
  gyro_bias_ += normal3(rng_) * (model_.gyro_walk_mdps_rts * kRadPerMdps * root_period);
  accel_bias_ += normal3(rng_) * (model_.accel_walk_ug_rts * 1e-3 * kMps2PerMg * root_period);
  constexpr double kTurnPerShaking = 0.01;  // rad/s per m/s^2
  const Vector3d shaking = model_.engine_mps2 * engine_shaking(t);
  truth.rate_rads = truth.rate_rads.cwiseProduct(gyro_scale_) + kTurnPerShaking * shaking;
  truth.specific_force_mps2 += shaking;
  truth.rate_rads += gyro_bias_ + normal3(rng_) * (model_.gyro_noise_mdps_rthz * kRadPerMdps * root_rate);
  truth.specific_force_mps2 +=
      accel_bias_ + normal3(rng_) * (model_.accel_noise_ug_rthz * 1e-3 * kMps2PerMg * root_rate);
  return truth;
}

std::optional<ImuSensor::Measured> ImuSensor::measure(double until) {
  const double t = static_cast<double>(count_) / (model_.rate_hz * clock_.rate());
  if (t >= until || t > trajectory_.duration()) return std::nullopt;
  const Inertial sensed = with_errors(low_passed(t), t);
  const double delay_s = model_.latency_min_s + model_.latency_jitter_s * rng_.uniform();
  return Measured{t, static_cast<std::uint32_t>(count_++), delay_s, sensed};
}

std::optional<WireEvent> ImuSensor::next(double until) {
  const std::optional<Measured> measured = measure(until);
  if (!measured) return std::nullopt;
  const double t = measured->t;
  const Quantised gyro = quantise(measured->sensed.rate_rads, kImuGyroMdpsPerLsb * kRadPerMdps);
  const Quantised accel = quantise(measured->sensed.specific_force_mps2, kImuAccelMgPerLsb * kMps2PerMg);
  ImuFrame frame;
  const auto bit = [](ImuStatus status) { return static_cast<unsigned>(status); };
  frame.status = static_cast<std::uint8_t>((gyro.clipped ? bit(ImuStatus::kGyroClipped) : 0U) |
                                           (accel.clipped ? bit(ImuStatus::kAccelClipped) : 0U) |
                                           (measured->count == 0 ? bit(ImuStatus::kFirstFrame) : 0U));
  frame.sequence = static_cast<std::uint16_t>(measured->count);
  frame.device_us = static_cast<std::uint64_t>(std::llround(clock_.reading(t) * 1e6));
  frame.gyro = gyro.counts;
  frame.accel = accel.counts;
  const double temperature_c = 31.0 + 1.5 * (1.0 - std::exp(-t / 120.0));
  frame.temperature =
      static_cast<std::int16_t>(std::lround((temperature_c - kImuTemperatureZeroC) * kImuTemperatureLsbPerC));
  const auto bytes = encode(frame);
  const auto taken = std::llround(t * 1e9);
  return WireEvent{Channel::kImu, taken, taken + std::llround(measured->delay_s * 1e9), {bytes.begin(), bytes.end()}};
}

}  // namespace slamd::sim
