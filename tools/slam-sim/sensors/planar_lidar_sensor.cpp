#include "tools/slam-sim/sensors/planar_lidar_sensor.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>

namespace slamd::sim {

double PlanarLidarSensor::range_of(int beam, double t, const std::vector<MovingBody>& movers, double movers_time, Rng& rng) const {
  const double angle = 2 * std::numbers::pi * beam / model_.beams, noise = rng.normal();
  const Pose T_world_lidar = around_.trajectory.pose_at(t) * around_.geometry.T_base_lidar;
  Ray ray{T_world_lidar.translation, T_world_lidar.rotation * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0),
          model_.max_range_m + 1.0};
  ray.porosity_draw = rng.exponential();
  Hit hit = around_.world.cast(ray);
  for (const MovingBody& mover : movers) {
    Ray relative = ray;
    relative.origin -= mover.velocity * (t - movers_time);
    intersect(mover.body, relative, hit);
  }
  if (!hit) return 0.0;
  const double range = hit.range + model_.range_noise_m * noise;
  return range >= model_.min_range_m && range <= model_.max_range_m ? range : 0.0;
}

std::optional<WireEvent> PlanarLidarSensor::next(double until) {
  const double beam_s = 1.0 / (model_.rate_hz * model_.beams);
  const double begin = static_cast<double>(count_) / model_.rate_hz, end = begin + beam_s * (model_.beams - 1);
  if (end >= until || end > around_.trajectory.duration()) return std::nullopt;
  Rng rng{seed_, Stream::kPlanarLidar, static_cast<std::uint64_t>(count_++)};
  const auto movers = around_.traffic.at(begin, around_.trajectory.pose_at(begin).translation, model_.max_range_m + 5.0);
  char text[64];
  std::snprintf(text, sizeof text, "%.9f,%.9f,%.9f,%.3f,", 0.0, 2 * std::numbers::pi / model_.beams, beam_s, model_.max_range_m);
  std::string line = text;
  for (int beam = 0; beam < model_.beams; ++beam) {
    const double range = range_of(beam, begin + beam_s * beam, movers, begin, rng);
    const int length = range > 0.0 ? std::snprintf(text, sizeof text, "%.3f", range) : std::snprintf(text, sizeof text, "0");
    if (beam > 0) line += ';';
    line.append(text, static_cast<std::size_t>(length));
  }
  const double arrival = end + model_.latency_min_s + model_.latency_jitter_s * rng.uniform();
  return WireEvent{Channel::kLidar, std::llround(begin * 1e9), std::llround(arrival * 1e9), {line.begin(), line.end()}};
}

}  // namespace slamd::sim
