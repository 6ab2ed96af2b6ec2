#include "tools/slam-sim/sensors/gps_sensor.hpp"

#include <cmath>
#include <numbers>
#include <sstream>

namespace slamd::sim {
namespace {

using Eigen::Vector3d;

Vector3d normal3(Rng& rng) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return {x, y, 1.8 * z};
}

}  // namespace

GpsSensor::GpsSensor(const GpsModel& model, const Trajectory& trajectory, const Vector3d& p_base_antenna,
                     std::uint64_t seed)
    : model_{model},
      trajectory_{trajectory},
      p_base_antenna_{p_base_antenna},
      local_{model.latitude_deg, model.longitude_deg, model.altitude_m},
      rng_{seed, Stream::kGps},
      correlated_{normal3(rng_) * model.correlated_m},
      jump_heading_{rng_.uniform(0.0, 2 * std::numbers::pi)} {}

Vector3d GpsSensor::error_at(double t) {
  const double keep = std::exp(-1.0 / (model_.rate_hz * model_.correlation_s));
  correlated_ = keep * correlated_ + std::sqrt(1.0 - keep * keep) * model_.correlated_m * normal3(rng_);
  Vector3d error = correlated_ + model_.white_m * normal3(rng_);
  for (const GpsDisturbance& d : disturbances_) {
    if (t < d.from || t >= d.to) continue;
    error += d.jump_m * Vector3d(std::cos(jump_heading_), std::sin(jump_heading_), 0.3);
  }
  return error;
}

NmeaFix GpsSensor::fix_at(double t) {
  const Motion motion = trajectory_.at(t);
  const Vector3d arm = motion.T_world_base.rotation * p_base_antenna_;
  const Vector3d velocity =
      motion.velocity + motion.T_world_base.rotation * motion.rate.cross(p_base_antenna_) + 0.05 * normal3(rng_);
  const Vector3d place = motion.T_world_base.translation + arm + error_at(t);
  NmeaFix fix;
  double height = 0.0;
  local_.Reverse(place.x(), place.y(), place.z(), fix.latitude_deg, fix.longitude_deg, height);
  fix.utc_s = model_.utc_start_s + t;
  fix.altitude_msl_m = height - model_.geoid_separation_m;
  fix.geoid_separation_m = model_.geoid_separation_m;
  fix.speed_mps = velocity.head<2>().norm();
  fix.course_deg = std::fmod(std::atan2(velocity.x(), velocity.y()) * 180.0 / std::numbers::pi + 360.0, 360.0);
  fix.hdop = model_.hdop + std::clamp(0.05 * rng_.normal(), -0.3, 0.3);
  fix.sigma_horizontal_m = std::hypot(model_.correlated_m, model_.white_m) * 1.2;
  fix.sigma_vertical_m = 1.8 * fix.sigma_horizontal_m;
  return fix;
}

std::vector<WireEvent> GpsSensor::next(double until) {
  const double t = static_cast<double>(count_) / model_.rate_hz;
  if (t >= until || t > trajectory_.duration()) return {};
  ++count_;
  const NmeaFix fix = fix_at(t);
  const auto taken = std::llround(t * 1e9);
  auto arrival = taken + std::llround((model_.latency_s + 0.003 * std::abs(rng_.normal())) * 1e9);
  std::vector<WireEvent> events;
  std::istringstream kinds{model_.sentences};
  for (std::string kind; std::getline(kinds, kind, ',');) {
    const std::string text = sentence(kind, fix);
    events.push_back({Channel::kGps, taken, arrival, {text.begin(), text.end()}});
    arrival += 6'000'000;  // 70 characters at 115200 baud
  }
  return events;
}

}  // namespace slamd::sim
