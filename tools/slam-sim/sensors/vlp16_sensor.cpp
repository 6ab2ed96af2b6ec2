#include "tools/slam-sim/sensors/vlp16_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamd::sim {
namespace {

constexpr double kSequence = 55.296e-6, kLaser = 2.304e-6;
constexpr int kBlocks = 12, kLasers = 16;
constexpr Optics kOptics{.nearest_m = 0.4, .farthest_m = 130.0, .reach_m = 100.0, .full_m = 100.0};
constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kRangeStep = 0.002;
constexpr std::size_t kPacketBytes = 1206;

/// User manual, table of vertical angles (degrees) and vertical corrections (millimetres) by laser.
constexpr std::array<double, kLasers> kElevationDeg{-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};
constexpr std::array<double, kLasers> kOffsetMm{11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1,
                                                5.1,  -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2};

void store(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) bytes[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value >> (8 * i));
}

void put(std::vector<std::uint8_t>& bytes, std::size_t at, const Echo& echo) {
  const double counts = std::round(echo.range_m / kRangeStep);
  if (counts < 1.0 || counts > 65535.0) return;
  store(bytes, at, static_cast<std::uint32_t>(counts), 2);
  bytes[at + 2] = echo.intensity;
}

}  // namespace

Vlp16Sensor::Vlp16Sensor(const LidarModel& model, const Surroundings& around, SensorClock clock, std::uint64_t seed)
    : model_{model}, caster_{model, kOptics, around}, clock_{std::move(clock)}, seed_{seed} {
  Rng unit{seed, Stream::kLidarUnit};
  for (double& bias : laser_bias_m_) bias = model.laser_bias_m * unit.normal();
}

double Vlp16Sensor::packet_period() const {
  return (dual() ? 12 : 24) * kSequence / clock_.rate();
}
double Vlp16Sensor::packet_time(std::int64_t index) const {
  return static_cast<double>(index) * packet_period();
}

Echoes Vlp16Sensor::fire(double t, int laser, const Movers& movers, Rng& rng) const {
  const double turn_rate = 2 * std::numbers::pi * model_.rpm / 60.0 * clock_.rate();
  const auto which = static_cast<std::size_t>(laser);
  return caster_.fire({t, std::fmod(turn_rate * t, 2 * std::numbers::pi), kElevationDeg[which] * kDeg,
                       Eigen::Vector3d(0.0, 0.0, kOffsetMm[which] * 1e-3), laser_bias_m_[which]},
                      movers, rng);
}

WireEvent Vlp16Sensor::packet(std::int64_t index) const {
  const double begin = packet_time(index), sequence = kSequence / clock_.rate(), laser_step = kLaser / clock_.rate();
  const double turn_rate = 2 * std::numbers::pi * model_.rpm / 60.0 * clock_.rate();
  Rng rng{seed_, Stream::kLidar, static_cast<std::uint64_t>(index)};
  const Movers movers = caster_.movers_at(begin);
  WireEvent event{Channel::kLidar, std::llround(begin * 1e9), 0, std::vector<std::uint8_t>(kPacketBytes)};
  for (int block = 0; block < kBlocks; block += dual() ? 2 : 1) {
    const double block_time = begin + 2.0 * (dual() ? block / 2 : block) * sequence;
    const std::size_t at = static_cast<std::size_t>(block) * 100;
    const double azimuth_cdeg = std::fmod(turn_rate * block_time / kDeg * 100.0, 36000.0);
    for (const std::size_t start : {at, dual() ? at + 100 : at}) {
      store(event.bytes, start, 0xEEFF, 2);
      store(event.bytes, start + 2, static_cast<std::uint32_t>(std::lround(azimuth_cdeg)) % 36000, 2);
    }
    for (int channel = 0; channel < 2 * kLasers; ++channel) {
      const double t = block_time + channel / kLasers * sequence + channel % kLasers * laser_step;
      const Echoes echoes = fire(t, channel % kLasers, movers, rng);
      const std::size_t slot = at + 4 + static_cast<std::size_t>(channel) * 3;
      put(event.bytes, slot, model_.mode == ReturnMode::kStrongest ? echoes.strongest : echoes.last);
      if (dual()) put(event.bytes, slot + 100, echoes.strongest);
    }
  }
  const double stamp_us = std::floor(std::fmod(clock_.reading(begin), 3600.0) * 1e6 + 1e-3);
  store(event.bytes, 1200, static_cast<std::uint32_t>(std::max(0.0, stamp_us)), 4);
  event.bytes[1204] = static_cast<std::uint8_t>(model_.mode);
  event.bytes[1205] = 0x22;
  const double delay = packet_period() + model_.latency_min_s + model_.latency_jitter_s * rng.uniform();
  event.arrival_ns = std::llround((begin + delay) * 1e9);
  return event;
}

}  // namespace slamd::sim
