#include "tools/slam-sim/motion/trajectory.hpp"

#include <cmath>
#include <numbers>

#include "tools/slam-sim/motion/euler.hpp"
#include "tools/slam-sim/motion/wobble.hpp"

namespace slamd::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kStep = 0.01;  // of the curve's knots: motion up to some 20 Hz
constexpr double kWheelbase = 2.7, kTrack = 1.6;
constexpr double kPitchPerAcceleration = -0.006;  // rad per m/s^2: nose up when speeding up
constexpr double kRollPerAcceleration = 0.010;    // leans out of the bend

/// Height, roll and pitch of a rigid car whose rear axle's middle is at the path point, from the ground under its
/// wheels.
struct Stance {
  double height, roll, pitch;
};

Stance stand_on(const HeightField& ground, const PathPoint& at) {
  const Vector2d forward(std::cos(at.yaw), std::sin(at.yaw));
  const Vector2d left(-forward.y(), forward.x());
  const auto wheel = [&](double x, double y) {
    const Vector2d p = at.position + x * forward + y * left;
    return ground.height(p.x(), p.y());
  };
  const double rear_left = wheel(0.0, kTrack / 2), rear_right = wheel(0.0, -kTrack / 2);
  const double front = 0.5 * (wheel(kWheelbase, kTrack / 2) + wheel(kWheelbase, -kTrack / 2));
  const double rear = 0.5 * (rear_left + rear_right);
  return {rear, std::atan2(rear_left - rear_right, kTrack), -std::atan2(front - rear, kWheelbase)};
}

/// Swerving about the path: offset to the left and the turn of the heading.
PathPoint swerved(PathPoint at, double s, double amplitude_m) {
  constexpr double kWave = 2 * std::numbers::pi / 27.0;
  const double fade = 1.0 - std::exp(-s * s / 100.0);
  const Vector2d left(-std::sin(at.yaw), std::cos(at.yaw));
  at.position += amplitude_m * fade * std::sin(kWave * s) * left;
  at.yaw += std::atan(amplitude_m * fade * kWave * std::cos(kWave * s));
  return at;
}

/// Bumps as smooth pulses in time: a chance per metre driven, each lifting and tipping the car for a quarter second.
class Bumps {
 public:
  Bumps(double per_m, double amplitude_m_or_rad) : per_m_{per_m}, amplitude_{amplitude_m_or_rad} {}

  Vector3d next(Rng& rng, double way_m) {  // heave, roll, pitch
    if (phase_ >= 1.0 && rng.chance(per_m_ * std::abs(way_m))) {
      phase_ = 0.0;
      shape_ = amplitude_ * Vector3d(rng.uniform(0.3, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
    }
    if (phase_ >= 1.0) return Vector3d::Zero();
    phase_ += kStep / 0.25;
    const double lift = std::sin(std::numbers::pi * std::min(phase_, 1.0));
    return shape_ * lift * lift;
  }

 private:
  double per_m_, amplitude_;
  double phase_ = 1.0;
  Vector3d shape_ = Vector3d::Zero();
};

/// Heave, roll, pitch, yaw of the body on its suspension, one value per knot.
class Suspension {
 public:
  explicit Suspension(const TrajectoryPlan& plan)
      : wobble_{plan.wobble}, rng_{plan.seed, Stream::kMotion}, bumps_{plan.wobble.bumps_per_m, 0.03} {
    for (int i = 0; i < 4; ++i) {
      body_.emplace_back(0.5, 2.2, rng_);
      wheels_.emplace_back(6.0, 11.0, rng_);
    }
  }

  Eigen::Vector4d next(double speed, double acceleration, double lateral_acceleration) {
    const double share = speed * speed / (speed * speed + 4.0);  // none at rest
    Eigen::Vector4d out = share * shake(static_cast<double>(count_++) * kStep);
    out.head<3>() += bumps_.next(rng_, speed * kStep);
    out[1] += kRollPerAcceleration * lateral_acceleration;
    out[2] += kPitchPerAcceleration * acceleration;
    return out;
  }

 private:
  Eigen::Vector4d shake(double t) const {
    Eigen::Vector4d out(wobble_.heave_m, wobble_.roll_rad, wobble_.pitch_rad, wobble_.yaw_rad);
    for (std::size_t i = 0; i < 4; ++i) {
      out[static_cast<Eigen::Index>(i)] *= body_[i].at(t) + wobble_.wheel_hop * wheels_[i].at(t);
    }
    return out;
  }

  Wobble wobble_;
  Rng rng_;
  Bumps bumps_;
  std::vector<BandNoise> body_, wheels_;
  std::int64_t count_ = 0;
};

std::vector<Vector6d> sample_motion(const HeightField& ground, const Path& path, const TrajectoryPlan& plan,
                                    const std::vector<double>& s) {
  std::vector<Vector6d> samples;
  Suspension suspension{plan};
  double yaw = 0.0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double after = s[std::min(i + 1, s.size() - 1)];
    const double before = i > 0 ? s[i - 1] : 2 * s[0] - after;
    const double speed = (after - before) / (2 * kStep);
    const double acceleration = (after - 2 * s[i] + before) / (kStep * kStep);
    const PathPoint at = swerved(path.at(s[i]), s[i], plan.slalom_m);
    const Stance stance = stand_on(ground, at);
    yaw = i == 0 ? at.yaw : yaw + std::remainder(at.yaw - yaw, 2 * std::numbers::pi);
    const Eigen::Vector4d wobble = suspension.next(speed, acceleration, speed * speed * at.curvature_per_m);
    Vector6d sample;
    sample << at.position, stance.height + wobble[0], stance.roll + wobble[1], stance.pitch + wobble[2],
        yaw + wobble[3];
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace

Trajectory::Trajectory(const World& world, const Path& path, const TrajectoryPlan& plan) {
  const std::vector<double> s = distance_over_time(path, plan.speed, kStep);
  curve_ = UniformSpline<6>(0.0, kStep, sample_motion(world.ground, path, plan, s));
  std::vector<Eigen::Matrix<double, 1, 1>> distances;
  for (const double value : s) distances.emplace_back(value);
  distance_ = UniformSpline<1>(0.0, kStep, distances);
}

Pose Trajectory::pose_at(double t) const {
  const auto curve = curve_.at(t);
  return {from_roll_pitch_yaw(curve.value.tail<3>()), curve.value.head<3>()};
}

Motion Trajectory::at(double t) const {
  const auto curve = curve_.at(t);
  const Vector3d angle = curve.value.tail<3>(), d = curve.first.tail<3>(), dd = curve.second.tail<3>();
  const double sr = std::sin(angle.x()), cr = std::cos(angle.x()), sp = std::sin(angle.y()), cp = std::cos(angle.y());
  Motion out;
  out.T_world_base = {from_roll_pitch_yaw(angle), curve.value.head<3>()};
  out.velocity = curve.first.head<3>();
  out.acceleration = curve.second.head<3>();
  // Body rates of R = Rz(yaw) Ry(pitch) Rx(roll): w = J(roll, pitch) * d, and its time derivative.
  out.rate = {d.x() - sp * d.z(), cr * d.y() + sr * cp * d.z(), -sr * d.y() + cr * cp * d.z()};
  out.rate_change = {
      dd.x() - sp * dd.z() - cp * d.y() * d.z(),
      cr * dd.y() + sr * cp * dd.z() - sr * d.x() * d.y() + (cr * cp * d.x() - sr * sp * d.y()) * d.z(),
      -sr * dd.y() + cr * cp * dd.z() - cr * d.x() * d.y() - (sr * cp * d.x() + cr * sp * d.y()) * d.z()};
  return out;
}

}  // namespace slamd::sim
