#include "tools/slam-sim/sensors/wheel_sensor.hpp"

#include <cmath>
#include <cstdio>

#include "tools/slam-sim/sensors/nmea_writer.hpp"

namespace slamd::sim {

WheelSensor::WheelSensor(const WheelModel& model, const Trajectory& trajectory, SensorClock clock, std::uint64_t seed)
    : model_{model}, trajectory_{trajectory}, clock_{std::move(clock)}, rng_{seed, Stream::kWheel} {
  Rng unit{seed, Stream::kWheelUnit};
  const double common = 0.01 * model.scale_percent * unit.normal(), balance = 0.005 * model.balance_percent * unit.normal();
  left_.scale = 1.0 + common - balance;
  right_.scale = 1.0 + common + balance;
  told_track_m_ = model.track_m * (1.0 + 0.01 * model.track_percent * unit.normal());
}

/// The way of each wheel's contact: midpoint rule in steps of some 5 ms.
void WheelSensor::roll(double from, double to) {
  constexpr int kSteps = 4;
  const double step = (to - from) / kSteps;
  double left = 0.0, right = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const Motion motion = trajectory_.at(from + (i + 0.5) * step);
    const double ahead = (motion.T_world_base.rotation.conjugate() * motion.velocity).x();
    const double turn = 0.5 * model_.track_m * motion.rate.z();
    left += (ahead - turn) * step;
    right += (ahead + turn) * step;
  }
  left_.way_m += left * left_.scale + model_.slip_m_rtm * std::sqrt(std::abs(left)) * rng_.normal();
  right_.way_m += right * right_.scale + model_.slip_m_rtm * std::sqrt(std::abs(right)) * rng_.normal();
}

double WheelSensor::count(Wheel& wheel) const {
  const double counted = model_.tick_m * std::floor(wheel.way_m / model_.tick_m);
  const double since = counted - wheel.counted_m;
  wheel.counted_m = counted;
  return since;
}

std::optional<WireEvent> WheelSensor::next(double until) {
  const double t = static_cast<double>(sentences_) / model_.rate_hz;
  if (t >= until || t > trajectory_.duration()) return std::nullopt;
  if (sentences_++ > 0) roll(t - 1.0 / model_.rate_hz, t);
  const double left = count(left_), right = count(right_);
  const double ahead = 0.5 * (left + right), turn = (right - left) / told_track_m_;
  x_m_ += ahead * std::cos(yaw_rad_ + 0.5 * turn);
  y_m_ += ahead * std::sin(yaw_rad_ + 0.5 * turn);
  yaw_rad_ += turn;
  char body[96];
  const auto device_us = static_cast<std::uint32_t>(static_cast<std::uint64_t>(std::llround(clock_.reading(t) * 1e6)));
  std::snprintf(body, sizeof body, "WODO,%u,%.5f,%.5f,%.6f", device_us, x_m_, y_m_, yaw_rad_);
  const std::string text = framed(body);
  const double delay = model_.latency_min_s + model_.latency_jitter_s * rng_.uniform();
  return WireEvent{Channel::kWheel, std::llround(t * 1e9), std::llround((t + delay) * 1e9), {text.begin(), text.end()}};
}

}  // namespace slamd::sim
