#pragma once
// Walls of points for the filter's tests: filled into a PlaneMap, and seen by a LiDAR at a given state. No ray casting.

#include <vector>

#include "estimator/filter/point_to_plane.hpp"
#include "tests/support/random_states.hpp"

namespace slamd::test {

/// A rectangle: centre, two edges from the centre to the middles of its sides.
struct Wall {
  Eigen::Vector3d centre, half_u, half_v;
  Eigen::Vector3d normal() const { return half_u.cross(half_v).normalized(); }
};

/// Six walls about the origin, seen from inside.
inline std::vector<Wall> room(const Eigen::Vector3d& half) {
  std::vector<Wall> walls;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Wall wall{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      wall.centre[axis] = side * half[axis];
      wall.half_u[u] = half[u];
      wall.half_v[v] = half[v];
      walls.push_back(wall);
    }
  }
  return walls;
}

/// Without the two walls across x: nothing tells where along x one is.
inline std::vector<Wall> corridor(const Eigen::Vector3d& half) {
  std::vector<Wall> walls = room(half);
  walls.erase(walls.begin(), walls.begin() + 2);
  return walls;
}

inline Eigen::Vector3d point_on(const Wall& wall, Random& random, double share = 1.0) {
  const double u = uniform(random, -share, share);
  return wall.centre + u * wall.half_u + uniform(random, -share, share) * wall.half_v;
}

/// Fills the map with points on a grid of step_m, noise along the normals.
inline void fill_map(PlaneMap& map, const std::vector<Wall>& walls, Random& random, double sigma_m,
                     double step_m = 0.1) {
  for (const Wall& wall : walls) {
    const int nu = static_cast<int>(wall.half_u.norm() / step_m), nv = static_cast<int>(wall.half_v.norm() / step_m);
    for (int i = -nu; i <= nu; ++i) {
      for (int j = -nv; j <= nv; ++j) {
        const Eigen::Vector3d p = wall.centre + wall.half_u * i / nu + wall.half_v * j / nv;
        map.insert((p + normal(random, sigma_m) * wall.normal()).cast<float>());
      }
    }
  }
}

/// Points on the walls' inner parts as the LiDAR at `truth` measures them, with noise along the normals.
inline std::vector<MeasuredPoint> see(const std::vector<Wall>& walls, const InertialState& truth, Random& random,
                                      int points, double sigma_m, double share = 0.85) {
  const Pose T_lidar_odom = truth.T_odom_lidar().inverse();
  std::vector<MeasuredPoint> out;
  for (int i = 0; i < points; ++i) {
    const Wall& wall = walls[static_cast<std::size_t>(i) % walls.size()];
    const Eigen::Vector3d p_odom = point_on(wall, random, share) + normal(random, sigma_m) * wall.normal();
    out.push_back({(T_lidar_odom * p_odom).cast<float>(), 1.0F});
  }
  return out;
}

}  // namespace slamd::test
