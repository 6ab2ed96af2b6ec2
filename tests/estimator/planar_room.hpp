#pragma once
// A room of straight walls for the planar tests: scans of a 2D LiDAR in it with known truth and seeded noise.

#include <cmath>
#include <random>
#include <vector>

#include "estimator/graph/group_se2.hpp"
#include "estimator/grid/scan_normals.hpp"
#include "estimator/types/laser_scan.hpp"

namespace slamd::test {

struct Wall {
  Eigen::Vector2d a, b;
};

/// 8 m x 6 m with a pillar, a niche and a wall that sticks out: no two views of it are alike.
inline std::vector<Wall> room() {
  return {{{-3, -2}, {5, -2}}, {{5, -2}, {5, 4}},   {{5, 4}, {1, 4}},   {{1, 4}, {1, 3}},    {{1, 3}, {-1, 3}},
          {{-1, 3}, {-1, 4}},  {{-1, 4}, {-3, 4}},  {{-3, 4}, {-3, -2}}, {{2, 0.5}, {2.5, 0.7}}, {{2.5, 0.7}, {2.2, 1.1}},
          {{2.2, 1.1}, {2, 0.5}}, {{-3, 1}, {-1.8, 1}}};
}

/// Distance to the first wall from T's origin in a direction of its frame; 0 beyond the range.
inline double cast(const std::vector<Wall>& walls, const PlanarPose& T, double angle_rad, double range_max_m) {
  const Eigen::Vector2d d{std::cos(T.yaw_rad + angle_rad), std::sin(T.yaw_rad + angle_rad)};
  double nearest = range_max_m;
  for (const Wall& wall : walls) {
    const Eigen::Vector2d e = wall.b - wall.a;
    const Eigen::Vector2d o = wall.a - T.translation;
    const double det = e.x() * d.y() - e.y() * d.x();
    if (std::abs(det) < 1e-12) continue;
    const double range = (e.x() * o.y() - e.y() * o.x()) / det;
    const double along = (d.x() * o.y() - d.y() * o.x()) / det;
    if (range > 0.0 && range < nearest && along >= 0.0 && along <= 1.0) nearest = range;
  }
  return nearest < range_max_m ? nearest : 0.0;
}

/// 360 beams at one instant.
inline LaserScan laser_scan(const std::vector<Wall>& walls, const PlanarPose& T, HostTime time, double sigma_m, std::mt19937_64& rng) {
  std::normal_distribution<double> noise{0.0, sigma_m};
  LaserScan scan{.time = time, .arrival = time, .range_max_m = 12.0F, .beams = {}};
  for (int i = 0; i < 360; ++i) {
    const double angle = i * M_PI / 180.0;
    const double range = cast(walls, T, angle, 12.0);
    scan.beams.push_back({static_cast<float>(angle), range > 0.0 ? static_cast<float>(range + noise(rng)) : 0.0F, 0.0F});
  }
  return scan;
}

/// The same as points with normals.
inline PlanarScan planar_scan(const LaserScan& scan) {
  PlanarScan out;
  out.time = scan.time;
  for (const LaserBeam& beam : scan.beams) {
    if (beam.range_m > 0.0F) out.points.emplace_back(beam.range_m * std::cos(beam.angle_rad), beam.range_m * std::sin(beam.angle_rad));
  }
  find_normals(out, 0.01);
  return out;
}

}  // namespace slamd::test
