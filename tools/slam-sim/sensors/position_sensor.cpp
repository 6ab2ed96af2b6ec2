#include "tools/slam-sim/sensors/position_sensor.hpp"

#include <cmath>
#include <numbers>

namespace slamd::sim {
namespace {

constexpr std::size_t kBytes = 512, kStampAt = 198, kPpsAt = 202, kNmeaAt = 206;
constexpr double kPeriod = 0.018577;

}  // namespace

PositionSensor::PositionSensor(const LidarModel& lidar, const GpsModel& gps, const Trajectory& trajectory,
                               SensorClock clock, std::uint64_t seed)
    : lidar_{lidar}, gps_{gps}, trajectory_{trajectory}, clock_{std::move(clock)}, seed_{seed} {}

double PositionSensor::packet_time(std::int64_t index) const {
  return (static_cast<double>(index) + 0.5) * kPeriod;
}

WireEvent PositionSensor::packet(std::int64_t index) const {
  const double t = packet_time(index);
  Rng rng{seed_, Stream::kPosition, static_cast<std::uint64_t>(index)};
  WireEvent event{Channel::kPosition, std::llround(t * 1e9), 0, std::vector<std::uint8_t>(kBytes)};
  const auto stamp = static_cast<std::uint32_t>(std::fmod(clock_.reading(t), 3600.0) * 1e6 + 1e-3);
  for (std::size_t i = 0; i < 4; ++i) event.bytes[kStampAt + i] = static_cast<std::uint8_t>(stamp >> (8 * i));
  if (lidar_.pps_locked) {
    event.bytes[kPpsAt] = 2;
    const double second = std::floor(t);  // the sentence names the second of the last pulse
    const Motion motion = trajectory_.at(second);
    const GeographicLib::LocalCartesian local{gps_.latitude_deg, gps_.longitude_deg, gps_.altitude_m};
    NmeaFix fix;
    const Eigen::Vector3d& p = motion.T_world_base.translation;
    local.Reverse(p.x(), p.y(), p.z(), fix.latitude_deg, fix.longitude_deg, fix.altitude_msl_m);
    fix.utc_s = gps_.utc_start_s + second;
    fix.speed_mps = motion.velocity.head<2>().norm();
    fix.course_deg =
        std::fmod(std::atan2(motion.velocity.x(), motion.velocity.y()) * 180.0 / std::numbers::pi + 360.0, 360.0);
    const std::string text = rmc(fix);
    std::copy(text.begin(), text.end(), event.bytes.begin() + kNmeaAt);
  }
  event.arrival_ns =
      event.taken_ns + std::llround((lidar_.latency_min_s + lidar_.latency_jitter_s * rng.uniform()) * 1e9);
  return event;
}

}  // namespace slamd::sim
