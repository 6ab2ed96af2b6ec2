#include "tools/slam-sim/sensors/airy_sensor.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace slamd::sim {
namespace {

constexpr double kColumn = 111.08e-6;
constexpr int kColumns = 4, kBlocks = 8, kBlockChannels = 48, kGroup = 8;
constexpr std::array<double, AiryUnit::kChannels / kGroup> kGroupDelay{
    0.0, 7.616e-6, 16.184e-6, 24.752e-6, 33.32e-6, 42.84e-6, 52.36e-6, 61.88e-6, 71.4e-6, 79.968e-6, 88.536e-6, 97.104e-6};
constexpr double kCentreHeight = 0.06056, kCentreRadius = 0.011433;
constexpr Optics kOptics{.nearest_m = 0.1, .farthest_m = 75.0, .reach_m = 42.0, .full_m = 60.0};
constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kRangeStep = 0.005;
constexpr std::size_t kPacketBytes = 1248, kImuBytes = 51, kHeaderBytes = 42, kBlockBytes = 4 + 3 * kBlockChannels;
constexpr double kDevicePeriod = 0.5;

void store(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i)
    bytes[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value >> (8 * (count - 1 - i)));
}

/// Seconds in six bytes, microseconds in four.
void store_stamp(std::vector<std::uint8_t>& bytes, std::size_t at, double seconds) {
  const auto us = static_cast<std::uint64_t>(std::max(0.0, std::floor(seconds * 1e6 + 0.25)));
  store(bytes, at, us / 1'000'000, 6);
  store(bytes, at + 6, us % 1'000'000, 4);
}

void put(std::vector<std::uint8_t>& bytes, std::size_t at, const Echo& echo) {
  const double counts = std::round(echo.range_m / kRangeStep);
  if (counts < 1.0 || counts > 16383.0) return;
  store(bytes, at, static_cast<std::uint64_t>(counts), 2);
  bytes[at + 2] = echo.intensity;
}

void store_angles(std::vector<std::uint8_t>& bytes, std::size_t at, const std::array<int, AiryUnit::kChannels>& angles_cdeg) {
  for (const int angle : angles_cdeg) {
    bytes[at] = angle < 0 ? 1 : 0;
    store(bytes, at + 1, static_cast<std::uint64_t>(std::abs(angle)), 2);
    at += 3;
  }
}

}  // namespace

/// 96 beams over 90 degrees, the groups that fire together spread over them; a unit's own errors are a tenth of a degree.
AiryUnit::AiryUnit(std::uint64_t seed) {
  Rng rng{seed, Stream::kLidarUnit, 2};
  for (int channel = 0; channel < kChannels; ++channel) {
    const int beam = channel % kGroup * (kChannels / kGroup) + channel / kGroup;
    const auto i = static_cast<std::size_t>(channel);
    elevation_cdeg[i] = std::clamp(static_cast<int>(std::lround(9000.0 * beam / (kChannels - 1) + 10.0 * rng.normal())), 0, 9000);
    azimuth_offset_cdeg[i] = static_cast<int>(std::lround(rng.uniform(-60.0, 60.0)));
  }
}

Pose airy_imu_in_lidar() {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ())), {0.0042, -0.0043, 0.0411}};
}

AirySensor::AirySensor(const LidarModel& model, const Surroundings& around, SensorClock clock, std::uint64_t seed)
    : model_{model}, caster_{model, kOptics, around}, clock_{std::move(clock)}, seed_{seed}, unit_{seed} {
  Rng rng{seed, Stream::kLidarUnit};
  for (double& bias : bias_m_) bias = model.laser_bias_m * rng.normal();
}

double AirySensor::packet_time(std::int64_t index) const {
  return static_cast<double>(index) * (dual() ? kColumns / 2 : kColumns) * kColumn / clock_.rate();
}

double AirySensor::turn_rate() const { return 2 * std::numbers::pi * model_.rpm / 60.0 * clock_.rate(); }

Echoes AirySensor::fire(double column_time, int channel, const Movers& movers, Rng& rng) const {
  const double t = column_time + kGroupDelay[static_cast<std::size_t>(channel / kGroup)] / clock_.rate();
  const double column = std::fmod(turn_rate() * t, 2 * std::numbers::pi);
  const auto i = static_cast<std::size_t>(channel);
  const double azimuth = std::fmod(column + unit_.azimuth_offset_cdeg[i] * 0.01 * kDeg + 2 * std::numbers::pi, 2 * std::numbers::pi);
  const Eigen::Vector3d origin(kCentreRadius * std::cos(column), -kCentreRadius * std::sin(column), kCentreHeight);
  return caster_.fire({t, azimuth, unit_.elevation_cdeg[i] * 0.01 * kDeg, origin, bias_m_[i]}, movers, rng);
}

WireEvent AirySensor::packet(std::int64_t index) const {
  const double begin = packet_time(index);
  Rng rng{seed_, Stream::kLidar, static_cast<std::uint64_t>(index)};
  const Movers movers = caster_.movers_at(begin);
  WireEvent event{Channel::kLidar, std::llround(begin * 1e9), 0, std::vector<std::uint8_t>(kPacketBytes)};
  store(event.bytes, 0, 0x55AA055A, 4);
  event.bytes[17] = dual() ? 3 : 0;
  store_stamp(event.bytes, 20, clock_.reading(begin));
  event.bytes[32] = 2;  // 96 channels
  const int columns = dual() ? kColumns / 2 : kColumns;
  for (int column = 0; column < columns; ++column) {
    const double column_time = begin + column * kColumn / clock_.rate();
    const double azimuth_cdeg = std::fmod(turn_rate() * column_time / kDeg * 100.0, 36000.0);
    const int blocks = kBlocks / columns;
    const std::size_t first = kHeaderBytes + static_cast<std::size_t>(column * blocks) * kBlockBytes;
    for (int block = 0; block < blocks; ++block) {
      const std::size_t at = first + static_cast<std::size_t>(block) * kBlockBytes;
      store(event.bytes, at, 0xFFEE, 2);
      store(event.bytes, at + 2, static_cast<std::uint64_t>(std::lround(azimuth_cdeg)) % 36000, 2);
    }
    for (int channel = 0; channel < AiryUnit::kChannels; ++channel) {
      const Echoes echoes = fire(column_time, channel, movers, rng);
      const std::size_t slot = first + static_cast<std::size_t>(channel / kBlockChannels) * kBlockBytes + 4 +
                               static_cast<std::size_t>(channel % kBlockChannels) * 3;
      put(event.bytes, slot, model_.mode == ReturnMode::kLast ? echoes.last : echoes.strongest);
      if (dual()) put(event.bytes, slot + 2 * kBlockBytes, echoes.last);
    }
  }
  const double delay = packet_time(1) + model_.latency_min_s + model_.latency_jitter_s * rng.uniform();
  event.arrival_ns = std::llround((begin + delay) * 1e9);
  return event;
}

AiryDeviceSensor::AiryDeviceSensor(const LidarModel& model, std::uint64_t seed)
    : model_{model}, seed_{seed}, bytes_(kPacketBytes) {
  const AiryUnit unit{seed};
  store(bytes_, 0, 0xA5FF005A11115555, 8);
  store(bytes_, 8, static_cast<std::uint64_t>(std::lround(model.rpm)), 2);
  store(bytes_, 34, 36000, 2);                       // field of view: from 0 to 360 degrees
  store(bytes_, 292, 0x0A1B00000000 + (seed & 0xFFFFFFFF), 6);  // serial number
  bytes_[300] = model.mode == ReturnMode::kDual ? 3 : 0;
  store_angles(bytes_, 468, unit.elevation_cdeg);
  store_angles(bytes_, 756, unit.azimuth_offset_cdeg);
  const Pose imu = airy_imu_in_lidar();
  const auto& q = imu.rotation;
  const auto& p = imu.translation;
  std::size_t at = 1092;
  for (const double value : {q.x(), q.y(), q.z(), q.w(), p.x(), p.y(), p.z()}) {
    store(bytes_, at, std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
    at += 4;
  }
  store(bytes_, kPacketBytes - 2, 0x0FF0, 2);
}

double AiryDeviceSensor::packet_time(std::int64_t index) const { return (static_cast<double>(index) + 0.1) * kDevicePeriod; }

WireEvent AiryDeviceSensor::packet(std::int64_t index) const {
  Rng rng{seed_, Stream::kPosition, static_cast<std::uint64_t>(index)};
  const std::int64_t taken = std::llround(packet_time(index) * 1e9);
  const double delay = model_.latency_min_s + model_.latency_jitter_s * rng.uniform();
  return {Channel::kPosition, taken, taken + std::llround(delay * 1e9), bytes_};
}

AiryImuSensor::AiryImuSensor(const ImuModel& imu, const Trajectory& trajectory, const Pose& T_base_lidar, SensorClock clock,
                             std::uint64_t seed)
    : clock_{clock}, imu_{imu, trajectory, T_base_lidar * airy_imu_in_lidar(), std::move(clock), seed} {}

std::optional<WireEvent> AiryImuSensor::next(double until) {
  constexpr double kAccelRange = 4.0 * 9.80665, kGyroRange = 500.0 * kDeg;
  const std::optional<ImuSensor::Measured> measured = imu_.measure(until);
  if (!measured) return std::nullopt;
  WireEvent event{Channel::kLidarImu, std::llround(measured->t * 1e9), 0, std::vector<std::uint8_t>(kImuBytes)};
  event.arrival_ns = event.taken_ns + std::llround(measured->delay_s * 1e9);
  store(event.bytes, 0, 0xAA555A05, 4);
  store_stamp(event.bytes, 4, clock_.reading(measured->t));
  const auto put_axes = [&](std::size_t at, const Eigen::Vector3d& value, double range) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double counts = std::clamp(std::round(value[i] / range * 32768.0), -32768.0, 32767.0);
      store(event.bytes, at + 4 * static_cast<std::size_t>(i), static_cast<std::uint32_t>(static_cast<std::int32_t>(counts)), 4);
    }
  };
  put_axes(14, measured->sensed.specific_force_mps2, kAccelRange);
  put_axes(26, measured->sensed.rate_rads, kGyroRange);
  event.bytes[43] = event.bytes[44] = 1;  // 4 g, 500 degrees a second
  store(event.bytes, 45, measured->count, 4);
  store(event.bytes, kImuBytes - 2, 0x0FF0, 2);
  return event;
}

}  // namespace slamd::sim
