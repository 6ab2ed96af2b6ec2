#include "tools/slam-sim/sensors/lidar_sensor.hpp"

#include <cmath>
#include <numbers>

namespace slamd::sim {
namespace {

using Eigen::Vector3d;

constexpr double kSequence = 55.296e-6, kLaser = 2.304e-6;
constexpr int kBlocks = 12, kLasers = 16;
constexpr double kMaxRange = 130.0, kMinRange = 0.4;
constexpr double kDeg = std::numbers::pi / 180.0;
constexpr std::size_t kPacketBytes = 1206;

/// User manual, table of vertical angles (degrees) and vertical corrections (millimetres) by laser.
constexpr std::array<double, kLasers> kElevationDeg{-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};
constexpr std::array<double, kLasers> kOffsetMm{11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1,
                                                5.1,  -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2};

void store(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) bytes[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value >> (8 * i));
}

/// Probability that the receiver sees the echo: power falls with the square of range and with reflectivity and
/// incidence. Rough surfaces return more than Lambert's law at grazing angles, hence the root of the cosine.
double detection(double range, double reflectivity, double cosine, double share) {
  const double reach = share * 100.0 * std::sqrt(reflectivity * std::sqrt(cosine) / 0.2);
  const double fade = 1.0 / (1.0 + std::exp((range - reach) / (0.06 * reach + 0.1)));
  return range > 100.0 ? fade * std::exp(-(range - 100.0) / 12.0) : fade;
}

/// A drop of rain in the beam at that range, unless something nearer stops the beam.
Hit before(const Hit& hit, double range) {
  return hit.range < range ? hit : Hit{range, Eigen::Vector3d::UnitZ(), Material{0.3F, 0.1F}};
}

}  // namespace

LidarSensor::LidarSensor(const LidarModel& model, const Surroundings& around, SensorClock clock, std::uint64_t seed)
    : model_{model}, around_{around}, clock_{std::move(clock)}, seed_{seed} {
  Rng unit{seed, Stream::kLidarUnit};
  for (double& bias : laser_bias_m_) bias = model.laser_bias_m * unit.normal();
}

double LidarSensor::packet_period() const {
  return (dual() ? 12 : 24) * kSequence / clock_.rate();
}
double LidarSensor::packet_time(std::int64_t index) const {
  return static_cast<double>(index) * packet_period();
}

Hit LidarSensor::cast(const Ray& ray, double t, const std::vector<MovingBody>& movers, double movers_time) const {
  Hit hit = around_.world.cast(ray);
  for (const MovingBody& mover : movers) {
    Ray relative = ray;
    relative.origin -= mover.velocity * (t - movers_time);
    intersect(mover.body, relative, hit);
  }
  return hit;
}

/// Sectors may reach over zero.
bool LidarSensor::blind(double azimuth_rad) const {
  if (model_.blind_from_deg == model_.blind_to_deg) return false;
  const double deg = azimuth_rad / kDeg;
  const bool after = deg >= model_.blind_from_deg, before = deg < model_.blind_to_deg;
  return model_.blind_from_deg < model_.blind_to_deg ? after && before : after || before;
}

LidarSensor::Return LidarSensor::sense(const Hit& hit, const Ray& ray, int laser, Rng& rng) const {
  const double seen = rng.uniform(), noise = rng.normal(), sparkle = rng.normal();
  if (!hit || hit.range < kMinRange) return {};
  const bool porous = hit.material.porous_depth_m > 0.0F;
  const double cosine = porous ? 0.6 : std::clamp(std::abs(hit.normal.dot(ray.direction)), 1e-3, 1.0);
  const double reflectivity = static_cast<double>(hit.material.reflectivity);
  if (seen > detection(hit.range, reflectivity, cosine, model_.reach)) return {};
  const double footprint =
      std::min(0.08, 0.13 * model_.divergence_rad * hit.range * std::sqrt(1 - cosine * cosine) / cosine);
  const double sigma = model_.range_noise_m > 0.0 ? std::hypot(model_.range_noise_m, footprint) : 0.0;
  const double range = hit.range + laser_bias_m_[static_cast<std::size_t>(laser)] + sigma * noise;
  const double brightness =
      reflectivity > 1.0 ? 100.0 + 50.0 * reflectivity * cosine : 100.0 * reflectivity * std::sqrt(cosine);
  const double counts = std::round(range / 0.002);
  if (counts < 1.0 || counts > 65535.0) return {};
  return {static_cast<std::uint16_t>(counts),
          static_cast<std::uint8_t>(std::clamp(brightness + 2.0 * sparkle, 1.0, 255.0))};
}

/// A beam that falls half on one body and half on another behind it.
LidarSensor::Echoes LidarSensor::split(const Hit& centre, const Hit& side, const Ray& ray, int laser, Rng& rng) const {
  Hit near = centre, far = side;
  if (far.range < near.range) std::swap(near, far);
  constexpr double kPulse = 0.6;  // closer bodies melt into one echo
  if (far && far.range - near.range < kPulse) {
    near.range += rng.uniform() * (far.range - near.range);
    const Return blended = sense(near, ray, laser, rng);
    return {blended, blended};
  }
  const Return first = sense(near, ray, laser, rng), second = sense(far, ray, laser, rng);
  if (first.distance_2mm == 0) return {second, second};
  if (second.distance_2mm == 0) return {first, first};
  return {second, first.intensity >= second.intensity ? first : second};
}

LidarSensor::Echoes LidarSensor::fire(const Aim& aim, const std::vector<MovingBody>& movers, double movers_time,
                                      Rng& rng) const {
  if (blind(aim.azimuth_rad)) return {};
  const auto laser = static_cast<std::size_t>(aim.laser);
  const Pose T_world_lidar = around_.trajectory.pose_at(aim.t) * around_.geometry.T_base_lidar;
  const auto direction = [&](double azimuth) {
    const double elevation = kElevationDeg[laser] * kDeg;
    return Vector3d(std::cos(elevation) * std::cos(azimuth), -std::cos(elevation) * std::sin(azimuth),
                    std::sin(elevation));
  };
  const Vector3d origin = T_world_lidar * Vector3d(0.0, 0.0, kOffsetMm[laser] * 1e-3);
  Ray ray{origin, T_world_lidar.rotation * direction(aim.azimuth_rad), kMaxRange};
  ray.porosity_draw = rng.exponential();
  Hit centre = cast(ray, aim.t, movers, movers_time);
  if (model_.clutter > 0.0 && rng.chance(model_.clutter)) centre = before(centre, 0.5 + 4.0 * rng.exponential());
  if (!model_.mixed_pixels) {
    const Return only = sense(centre, ray, aim.laser, rng);
    return {only, only};
  }
  const double half = (rng.chance(0.5) ? 0.5 : -0.5) * model_.divergence_rad;
  Ray edge{origin, T_world_lidar.rotation * direction(aim.azimuth_rad + half), kMaxRange};
  edge.porosity_draw = rng.exponential();
  return split(centre, cast(edge, aim.t, movers, movers_time), ray, aim.laser, rng);
}

WireEvent LidarSensor::packet(std::int64_t index) const {
  const double begin = packet_time(index), sequence = kSequence / clock_.rate(), laser_step = kLaser / clock_.rate();
  const double turn_rate = 2 * std::numbers::pi * model_.rpm / 60.0 * clock_.rate();
  Rng rng{seed_, Stream::kLidar, static_cast<std::uint64_t>(index)};
  const Vector3d place = around_.trajectory.pose_at(begin).translation;
  const std::vector<MovingBody> movers = around_.traffic.at(begin, place, kMaxRange);
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
      const Echoes echoes =
          fire({t, std::fmod(turn_rate * t, 2 * std::numbers::pi), channel % kLasers}, movers, begin, rng);
      const auto put = [&](std::size_t slot, const Return& found) {
        store(event.bytes, slot, found.distance_2mm, 2);
        event.bytes[slot + 2] = found.intensity;
      };
      const std::size_t slot = at + 4 + static_cast<std::size_t>(channel) * 3;
      put(slot, model_.mode == ReturnMode::kStrongest ? echoes.strongest : echoes.last);
      if (dual()) put(slot + 100, echoes.strongest);
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
