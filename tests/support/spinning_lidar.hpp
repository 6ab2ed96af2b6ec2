#pragma once
// A 16-laser spinning LiDAR that casts each firing at its own time and packs 24 of them a packet, as the decoder would
// hand them on. Knows no world: the caller gives the range of a ray. Not the wire format.

#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include "estimator/types/lidar_packet.hpp"

namespace slamd::test {

class SpinningLidar {
 public:
  static constexpr int kFirings = 24;
  static constexpr int kLasers = 16;
  static constexpr double kFiring_s = 55.296e-6;
  static constexpr double kLaser_s = 2.304e-6;
  static constexpr double kPacket_s = kFirings * kFiring_s;

  explicit SpinningLidar(double rpm = 600.0, double start_azimuth_deg = 0.0, HostTime origin = {})
      : degrees_per_second_{6.0 * rpm}, start_azimuth_deg_{start_azimuth_deg}, origin_{origin} {}

  HostTime packet_time(std::int64_t index) const {
    return origin_ + from_seconds(static_cast<double>(index) * kPacket_s);
  }

  /// ray(HostTime, direction as unit vector of the lidar frame) gives the range in metres, not finite: no return.
  template <class Ray>
  LidarPacket packet(std::int64_t index, const Ray& ray) const {
    LidarPacket out;
    out.time = packet_time(index);
    out.span = from_seconds(kPacket_s);
    out.arrival = out.time + out.span + std::chrono::microseconds{30};
    out.azimuth_begin_cdeg = azimuth_cdeg(index, 0);
    out.azimuth_end_cdeg = azimuth_cdeg(index, kFirings - 1);
    for (int firing = 0; firing < kFirings; ++firing)
      for (int laser = 0; laser < kLasers; ++laser) cast(index, firing, laser, ray, out);
    return out;
  }

 private:
  double azimuth_deg(std::int64_t index, int firing) const {
    const double t = static_cast<double>(index) * kPacket_s + firing * kFiring_s;
    return start_azimuth_deg_ + degrees_per_second_ * t;
  }
  std::uint16_t azimuth_cdeg(std::int64_t index, int firing) const {
    return static_cast<std::uint16_t>(std::llround(100.0 * azimuth_deg(index, firing)) % 36'000);
  }

  template <class Ray>
  void cast(std::int64_t index, int firing, int laser, const Ray& ray, LidarPacket& out) const {
    const double offset_s = firing * kFiring_s + laser * kLaser_s;
    const double azimuth = (azimuth_deg(index, firing) + degrees_per_second_ * laser * kLaser_s) * std::numbers::pi / 180;
    const double elevation = (2.0 * laser - 15.0) * std::numbers::pi / 180;
    const Eigen::Vector3d direction{std::cos(elevation) * std::sin(azimuth), std::cos(elevation) * std::cos(azimuth),
                                    std::sin(elevation)};
    const double range_m = ray(out.time + from_seconds(offset_s), direction);
    if (!std::isfinite(range_m)) return;
    const Eigen::Vector3f p = (range_m * direction).cast<float>();
    out.points[out.point_count++] = {p.x(),
                                     p.y(),
                                     p.z(),
                                     static_cast<std::int32_t>(from_seconds(offset_s).count()),
                                     azimuth_cdeg(index, firing),
                                     static_cast<std::uint8_t>(laser),
                                     100,
                                     0};
  }

  double degrees_per_second_;
  double start_azimuth_deg_;
  HostTime origin_;
};

}  // namespace slamd::test
