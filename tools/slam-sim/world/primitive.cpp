#include "tools/slam-sim/world/primitive.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace slamd::sim {
namespace {

using Eigen::Vector3d;

struct Interval {
  double enter;
  double leave;
  Vector3d normal;  // body frame, at the entry
};
using Chord = std::optional<Interval>;

Chord box_chord(const Vector3d& o, const Vector3d& d, const Vector3d& half) {
  Interval chord{-1e300, 1e300, Vector3d::Zero()};
  int axis = 0;
  for (int i = 0; i < 3; ++i) {
    if (d[i] == 0.0) {
      if (std::abs(o[i]) > half[i]) return std::nullopt;
      continue;
    }
    const double inverse = 1.0 / d[i];
    const double centre = -o[i] * inverse;
    const double reach = half[i] * std::abs(inverse);
    if (centre - reach > chord.enter) {
      chord.enter = centre - reach;
      axis = i;
    }
    chord.leave = std::min(chord.leave, centre + reach);
  }
  if (chord.enter > chord.leave) return std::nullopt;
  chord.normal[axis] = d[axis] > 0.0 ? -1.0 : 1.0;
  return chord;
}

struct Roots {
  double low;
  double high;
};

/// a t^2 + 2 b t + c = 0
std::optional<Roots> solve(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0 || a == 0.0) return std::nullopt;
  const double root = std::sqrt(discriminant);
  const double first = (-b - root) / a;
  const double second = (-b + root) / a;
  return Roots{std::min(first, second), std::max(first, second)};
}

Chord ellipsoid_chord(const Vector3d& o, const Vector3d& d, const Vector3d& half) {
  const Vector3d origin = o.cwiseQuotient(half);
  const Vector3d direction = d.cwiseQuotient(half);
  const auto roots = solve(direction.squaredNorm(), origin.dot(direction), origin.squaredNorm() - 1.0);
  if (!roots) return std::nullopt;
  const Vector3d normal = (origin + roots->low * direction).cwiseQuotient(half).normalized();
  return Interval{roots->low, roots->high, normal};
}

/// Clips a chord to |z| <= half_z; where the slab is entered later than the side, the entry is a cap.
Chord clip_to_slab(Interval chord, const Vector3d& o, const Vector3d& d, double half_z) {
  if (d.z() == 0.0) return std::abs(o.z()) <= half_z ? Chord{chord} : std::nullopt;
  const double inverse = 1.0 / d.z();
  const double centre = -o.z() * inverse;
  const double reach = half_z * std::abs(inverse);
  if (centre - reach > chord.enter) {
    chord.enter = centre - reach;
    chord.normal = Vector3d(0.0, 0.0, d.z() > 0.0 ? -1.0 : 1.0);
  }
  chord.leave = std::min(chord.leave, centre + reach);
  return chord.enter <= chord.leave ? Chord{chord} : std::nullopt;
}

Chord cylinder_chord(const Vector3d& o, const Vector3d& d, const Vector3d& half) {
  const double a = d.head<2>().squaredNorm();
  const double c = o.head<2>().squaredNorm() - half.x() * half.x();
  Interval side{-1e300, 1e300, Vector3d::UnitZ()};
  if (a > 1e-18) {
    const auto roots = solve(a, o.head<2>().dot(d.head<2>()), c);
    if (!roots) return std::nullopt;
    side = {roots->low, roots->high, (o + roots->low * d)};
    side.normal.z() = 0.0;
    side.normal.normalize();
  } else if (c > 0.0) {
    return std::nullopt;
  }
  return clip_to_slab(side, o, d, half.z());
}

/// x^2 + y^2 = k^2 (z - apex)^2 below the apex.
Chord cone_chord(const Vector3d& o, const Vector3d& d, const Vector3d& half) {
  const double k = half.x() / (2.0 * half.z());
  const Vector3d origin = o - Vector3d(0.0, 0.0, half.z());
  const double a = d.head<2>().squaredNorm() - k * k * d.z() * d.z();
  const double b = origin.head<2>().dot(d.head<2>()) - k * k * origin.z() * d.z();
  const double c = origin.head<2>().squaredNorm() - k * k * origin.z() * origin.z();
  const auto roots = solve(a, b, c);
  if (!roots) return std::nullopt;
  const auto normal_at = [&](double t) {
    const Vector3d p = origin + t * d;
    return Vector3d(p.x(), p.y(), -k * k * p.z()).normalized();
  };
  // A steep ray (a < 0) is inside outside the roots: downwards it enters at the high root, upwards it leaves at the
  // low.
  Interval side{roots->low, roots->high, normal_at(roots->low)};
  if (a < 0.0 && d.z() < 0.0) side = {roots->high, 1e300, normal_at(roots->high)};
  if (a < 0.0 && d.z() > 0.0) side = {-1e300, roots->low, Vector3d::UnitZ()};
  const auto chord = clip_to_slab(side, o, d, half.z());
  if (!chord || origin.z() + 0.5 * (chord->enter + chord->leave) * d.z() > 0.0) return std::nullopt;
  return chord;
}

Chord chord_of(const Primitive& body, const Vector3d& o, const Vector3d& d) {
  switch (body.shape) {
    case Shape::kBox:
      return box_chord(o, d, body.half);
    case Shape::kCylinder:
      return cylinder_chord(o, d, body.half);
    case Shape::kEllipsoid:
      return ellipsoid_chord(o, d, body.half);
    case Shape::kCone:
      return cone_chord(o, d, body.half);
  }
  return std::nullopt;
}

}  // namespace

Eigen::AlignedBox3d Primitive::bounds() const {
  const Vector3d reach =
      R_world_body.cwiseAbs() *
      (shape == Shape::kBox || shape == Shape::kEllipsoid ? half : Vector3d(half.x(), half.x(), half.z()));
  return {centre - reach, centre + reach};
}

Primitive make_box(const Vector3d& centre, const Vector3d& half, double yaw, Material material) {
  return {Shape::kBox, material, centre, half, Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix()};
}

Primitive make_upright(Shape shape, const Vector3d& centre, const Vector3d& half, Material material) {
  return {shape, material, centre, half, Eigen::Matrix3d::Identity()};
}

void intersect(const Primitive& body, const Ray& ray, Hit& hit) {
  const Vector3d o = body.R_world_body.transpose() * (ray.origin - body.centre);
  const Vector3d d = body.R_world_body.transpose() * ray.direction;
  const Chord chord = chord_of(body, o, d);
  if (!chord || chord->enter <= 0.0) return;
  const double range = chord->enter + ray.porosity_draw * static_cast<double>(body.material.porous_depth_m);
  if (range >= hit.range || range > ray.max_range || range > chord->leave) return;
  hit = {range, body.R_world_body * chord->normal, body.material};
}

}  // namespace slamd::sim
