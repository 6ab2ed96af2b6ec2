#include "estimator/graph/gnss_track.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamd {

namespace {

constexpr double kMaxKnotGap_s = 1.0;        // between two keyframes; in more a vehicle may stop and go,
constexpr double kMaxSteadyGap_s = 5.0;      // unless it is slow and its way as long as both its velocities say
constexpr double kSteadyShare = 0.3;         // to this share of the mean velocity
constexpr double kSlow_mps = 1.0;            // below, the course is noise
constexpr double kStep_s = 0.02;             // of the numerical derivative
constexpr double kUnknownHeight_m = 1.0e4;   // sigma of a height that the receiver did not give

/// Cubic Hermite: position at share s of a span of dt seconds.
Eigen::Vector3d hermite(const Eigen::Vector3d& p0, const Eigen::Vector3d& v0, const Eigen::Vector3d& p1,
                        const Eigen::Vector3d& v1, double s, double dt) {
  const double s2 = s * s;
  const double s3 = s2 * s;
  return (2.0 * s3 - 3.0 * s2 + 1.0) * p0 + (s3 - 2.0 * s2 + s) * dt * v0 + (3.0 * s2 - 2.0 * s3) * p1 +
         (s3 - s2) * dt * v1;
}

std::optional<Eigen::Vector2d> velocity_of(const GnssFix& fix) {
  if (!fix.velocity_valid || !(fix.speed_mps > kSlow_mps) || !std::isfinite(fix.course_deg)) return std::nullopt;
  const double course_rad = fix.course_deg * std::numbers::pi / 180.0;
  return fix.speed_mps * Eigen::Vector2d{std::sin(course_rad), std::cos(course_rad)};
}

bool is_steady(const Eigen::Vector3d& way_m, double dt, const Eigen::Vector3d& v0, const Eigen::Vector3d& v1) {
  const Eigen::Vector3d mean_mps = way_m / dt;
  return std::max((v0 - mean_mps).norm(), (v1 - mean_mps).norm()) < kSteadyShare * mean_mps.norm();
}

}  // namespace

void GnssTrack::add(const Keyframe& keyframe) {
  knots_.push_back({keyframe.state.time, keyframe.state.T_odom_base, keyframe.state.velocity_mps});
}

std::optional<std::size_t> GnssTrack::keyframe_before(HostTime time) const {
  const auto after = std::ranges::upper_bound(knots_, time, {}, &Knot::time);
  if (after == knots_.begin() || after == knots_.end()) return std::nullopt;
  return static_cast<std::size_t>(after - knots_.begin()) - 1;
}

std::optional<Pose> GnssTrack::T_keyframe_base(std::size_t i, HostTime time) const {
  if (i + 1 >= knots_.size()) return std::nullopt;
  const Knot& a = knots_[i];
  const Knot& b = knots_[i + 1];
  const double dt = to_seconds(b.time - a.time);
  if (dt <= 0.0 || dt > kMaxSteadyGap_s) return std::nullopt;
  const Eigen::Vector3d way_m = b.T_odom_base.translation - a.T_odom_base.translation;
  if (dt > kMaxKnotGap_s && !is_steady(way_m, dt, a.velocity_mps, b.velocity_mps)) return std::nullopt;
  const double s = to_seconds(time - a.time) / dt;
  Pose T_odom_base = interpolate(a.T_odom_base, b.T_odom_base, s);
  T_odom_base.translation = hermite(a.T_odom_base.translation, a.velocity_mps, b.T_odom_base.translation, b.velocity_mps, s, dt);
  return a.T_odom_base.inverse() * T_odom_base;
}

std::optional<TiedFix> GnssTrack::tie(const GnssFix& fix, HostTime time, const Eigen::Vector3d& p_enu) const {
  const std::optional<std::size_t> keyframe = keyframe_before(time);
  if (!keyframe) return std::nullopt;
  const std::optional<Pose> T_keyframe_fix = T_keyframe_base(*keyframe, time);
  if (!T_keyframe_fix) return std::nullopt;
  TiedFix tied;
  tied.time = time;
  const Knot& a = knots_[*keyframe];
  const Knot& b = knots_[*keyframe + 1];
  const Eigen::Vector3d before = *T_keyframe_base(*keyframe, time - from_seconds(kStep_s)) * p_base_antenna_;
  const Eigen::Vector3d after = *T_keyframe_base(*keyframe, time + from_seconds(kStep_s)) * p_base_antenna_;
  tied.velocity_odom_mps = a.T_odom_base.rotation * (after - before) / (2.0 * kStep_s);
  tied.acceleration_odom_mps2 = (b.velocity_mps - a.velocity_mps) / to_seconds(b.time - a.time);
  tied.velocity_enu_mps = velocity_of(fix);
  tied.position.keyframe = *keyframe;
  tied.position.p_keyframe_antenna = *T_keyframe_fix * p_base_antenna_;
  tied.position.p_enu = p_enu;
  const double sigma_up_m = fix.height_valid ? fix.sigma_vertical_m : kUnknownHeight_m;
  tied.position.sigma_m = {fix.sigma_horizontal_m, fix.sigma_horizontal_m, sigma_up_m};
  return tied;
}

}  // namespace slamd
