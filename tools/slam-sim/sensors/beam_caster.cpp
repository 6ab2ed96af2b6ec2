#include "tools/slam-sim/sensors/beam_caster.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamd::sim {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

/// A drop of rain in the beam at that range, unless something nearer stops the beam.
Hit before(const Hit& hit, double range) {
  return hit.range < range ? hit : Hit{range, Eigen::Vector3d::UnitZ(), Material{0.3F, 0.1F}};
}

}  // namespace

/// Probability that the receiver sees the echo: power falls with the square of range and with reflectivity and
/// incidence. Rough surfaces return more than Lambert's law at grazing angles, hence the root of the cosine.
double BeamCaster::detection(double range, double reflectivity, double cosine) const {
  const double reach = model_.reach * optics_.reach_m * std::sqrt(reflectivity * std::sqrt(cosine) / 0.2);
  const double fade = 1.0 / (1.0 + std::exp((range - reach) / (0.06 * reach + 0.1)));
  return range > optics_.full_m ? fade * std::exp(-(range - optics_.full_m) / (0.12 * optics_.full_m)) : fade;
}

Movers BeamCaster::movers_at(double t) const {
  return {around_.traffic.at(t, around_.trajectory.pose_at(t).translation, optics_.farthest_m), t};
}

Hit BeamCaster::cast(const Ray& ray, double t, const Movers& movers) const {
  Hit hit = around_.world.cast(ray);
  for (const MovingBody& mover : movers.bodies) {
    Ray relative = ray;
    relative.origin -= mover.velocity * (t - movers.time);
    intersect(mover.body, relative, hit);
  }
  return hit;
}

/// Sectors may reach over zero.
bool BeamCaster::blind(double azimuth_rad) const {
  if (model_.blind_from_deg == model_.blind_to_deg) return false;
  const double deg = azimuth_rad / kDeg;
  const bool after = deg >= model_.blind_from_deg, before = deg < model_.blind_to_deg;
  return model_.blind_from_deg < model_.blind_to_deg ? after && before : after || before;
}

Echo BeamCaster::sense(const Hit& hit, const Ray& ray, double bias_m, Rng& rng) const {
  const double seen = rng.uniform(), noise = rng.normal(), sparkle = rng.normal();
  if (!hit || hit.range < optics_.nearest_m) return {};
  const bool porous = hit.material.porous_depth_m > 0.0F;
  const double cosine = porous ? 0.6 : std::clamp(std::abs(hit.normal.dot(ray.direction)), 1e-3, 1.0);
  const double reflectivity = static_cast<double>(hit.material.reflectivity);
  if (seen > detection(hit.range, reflectivity, cosine)) return {};
  const double footprint =
      std::min(0.08, 0.13 * model_.divergence_rad * hit.range * std::sqrt(1 - cosine * cosine) / cosine);
  const double own = model_.range_noise_m > 0.0 ? std::hypot(model_.range_noise_m, footprint) : 0.0;
  const double sigma = own > 0.0 && optics_.noise_share > 0.0 ? std::hypot(own, optics_.noise_share * hit.range) : own;
  const double brightness =
      reflectivity > 1.0 ? 100.0 + 50.0 * reflectivity * cosine : 100.0 * reflectivity * std::sqrt(cosine);
  return {std::max(0.0, hit.range + bias_m + sigma * noise),
          static_cast<std::uint8_t>(std::clamp(brightness + 2.0 * sparkle, 1.0, 255.0))};
}

/// A beam that falls half on one body and half on another behind it.
Echoes BeamCaster::split(const Hit& centre, const Hit& side, const Ray& ray, double bias_m, Rng& rng) const {
  Hit near = centre, far = side;
  if (far.range < near.range) std::swap(near, far);
  constexpr double kPulse = 0.6;  // closer bodies melt into one echo
  if (far && far.range - near.range < kPulse) {
    near.range += rng.uniform() * (far.range - near.range);
    const Echo blended = sense(near, ray, bias_m, rng);
    return {blended, blended};
  }
  const Echo first = sense(near, ray, bias_m, rng), second = sense(far, ray, bias_m, rng);
  if (first.range_m == 0.0) return {second, second};
  if (second.range_m == 0.0) return {first, first};
  return {second, first.intensity >= second.intensity ? first : second};
}

Echoes BeamCaster::fire(const Beam& beam, const Movers& movers, Rng& rng) const {
  if (blind(beam.azimuth_rad)) return {};
  const Pose T_world_lidar = around_.trajectory.pose_at(beam.t) * around_.geometry.T_base_lidar;
  const Eigen::Vector3d origin = T_world_lidar * beam.origin_lidar;
  const auto towards = [&](double azimuth) {
    return T_world_lidar.rotation * Eigen::Vector3d(std::cos(beam.elevation_rad) * std::cos(azimuth),
                                                    -std::cos(beam.elevation_rad) * std::sin(azimuth), std::sin(beam.elevation_rad));
  };
  Ray ray{origin, towards(beam.azimuth_rad), optics_.farthest_m};
  ray.porosity_draw = rng.exponential();
  Hit centre = cast(ray, beam.t, movers);
  if (model_.clutter > 0.0 && rng.chance(model_.clutter)) centre = before(centre, 0.5 + 4.0 * rng.exponential());
  if (!model_.mixed_pixels) {
    const Echo only = sense(centre, ray, beam.bias_m, rng);
    return {only, only};
  }
  const double half = (rng.chance(0.5) ? 0.5 : -0.5) * model_.divergence_rad;
  Ray edge{origin, towards(beam.azimuth_rad + half), optics_.farthest_m};
  edge.porosity_draw = rng.exponential();
  return split(centre, cast(edge, beam.t, movers), ray, beam.bias_m, rng);
}

}  // namespace slamd::sim
