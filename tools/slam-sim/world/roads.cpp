#include "tools/slam-sim/world/roads.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::sim {
namespace {

using Eigen::Vector2d;

Vector2d left_of(const Vector2d& direction) {
  return {-direction.y(), direction.x()};
}

/// Evenly spaced points of a polyline; the last one of an open line is kept.
Polyline resampled(const Polyline& line, bool closed, double step_m) {
  Polyline out;
  double carry = 0.0;
  const std::size_t segments = closed ? line.size() : line.size() - 1;
  for (std::size_t i = 0; i < segments; ++i) {
    const Vector2d& from = line[i];
    const Vector2d along = line[(i + 1) % line.size()] - from;
    const double length = along.norm();
    if (length == 0.0) continue;
    double at = carry;
    for (; at < length; at += step_m) out.push_back(from + along * (at / length));
    carry = at - length;
  }
  if (!closed) out.push_back(line.back());
  return out;
}

void append_arc(Polyline& out, const Vector2d& before, const Vector2d& corner, const Vector2d& after, double radius_m) {
  const Vector2d in = (corner - before).normalized();
  const Vector2d away = (after - corner).normalized();
  const double turn = std::atan2(in.x() * away.y() - in.y() * away.x(), in.dot(away));
  const double longest = 0.49 * std::min((corner - before).norm(), (after - corner).norm());
  if (std::abs(turn) < 1e-3) {
    out.push_back(corner);
    return;
  }
  const double tangent = std::min(longest, radius_m * std::tan(std::abs(turn) / 2));
  const double radius = tangent / std::tan(std::abs(turn) / 2);
  const Vector2d start = corner - in * tangent;
  const Vector2d centre = start + left_of(in) * std::copysign(radius, turn);
  constexpr int kSteps = 12;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = turn * i / kSteps;
    out.push_back(centre + Eigen::Rotation2Dd(angle) * (start - centre));
  }
}

}  // namespace

Polyline rounded(const Polyline& corners, bool closed, double radius_m, double step_m) {
  Polyline line;
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (!closed && (i == 0 || i + 1 == n)) {
      line.push_back(corners[i]);
    } else {
      append_arc(line, corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n], radius_m);
    }
  }
  return resampled(line, closed, step_m);
}

Polyline shifted(const Polyline& line, bool closed, double left_m) {
  Polyline out;
  const std::size_t n = line.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2d& before = (i > 0 || closed) ? line[(i + n - 1) % n] : line[i];
    const Vector2d& after = (i + 1 < n || closed) ? line[(i + 1) % n] : line[i];
    out.push_back(line[i] + left_m * left_of((after - before).normalized()));
  }
  return out;
}

Polyline warped(const Polyline& line, const Warp& warp) {
  Polyline out;
  for (const Vector2d& p : line) out.push_back(warp(p));
  return out;
}

double distance_to(const Polyline& line, bool closed, const Vector2d& p) {
  double best = 1e300;
  const std::size_t segments = closed ? line.size() : line.size() - 1;
  for (std::size_t i = 0; i < segments; ++i) {
    const Vector2d along = line[(i + 1) % line.size()] - line[i];
    const double u = std::clamp((p - line[i]).dot(along) / std::max(along.squaredNorm(), 1e-12), 0.0, 1.0);
    best = std::min(best, (line[i] + u * along - p).squaredNorm());
  }
  return std::sqrt(best);
}

std::vector<RoadPlace> places_along(const Polyline& line, bool closed, double spacing_m, double left_m) {
  std::vector<RoadPlace> places;
  const Polyline even = resampled(line, closed, spacing_m);
  const Polyline beside = shifted(even, closed, left_m);
  for (std::size_t i = 0; i + (closed ? 0 : 1) < even.size(); ++i) {
    const Vector2d along = even[(i + 1) % even.size()] - even[i];
    places.push_back({beside[i], std::atan2(along.y(), along.x())});
  }
  return places;
}

}  // namespace slamd::sim
