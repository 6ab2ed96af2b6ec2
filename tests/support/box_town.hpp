#pragma once
// A town of boxes on a plain, ray-cast exactly into keyframes of a vehicle that drives through it: for tests of the back
// end, where a whole simulated drive would take too long. No noise but what is asked for, no motion within a scan.

#include <Eigen/Geometry>
#include <limits>
#include <numbers>
#include <vector>

#include "estimator/types/keyframe.hpp"
#include "tests/support/random_states.hpp"

namespace slamd::test {

inline const Eigen::Vector3d kLidarInBase{0.45, 0.0, 1.9};
inline constexpr double kRoadRadius_m = 40.0;   // of a road around a small town
inline constexpr double kRoadSpacing_m = 2.0;   // of keyframes on it

struct BoxTown {
  std::vector<Eigen::AlignedBox3d> boxes;

  /// Boxes of all sizes on both sides of the circle of radius_m, none on the road.
  static BoxTown around_circle(double radius_m, std::uint64_t seed) {
    BoxTown town;
    Random random{seed};
    for (double along_m = 0.0; along_m < 2.0 * std::numbers::pi * radius_m; along_m += 7.0) {
      const double angle = along_m / radius_m;
      for (const double side : {-1.0, 1.0}) {
        const double r = radius_m + side * uniform(random, 9.0, 22.0);
        const Eigen::Vector3d centre{r * std::cos(angle), r * std::sin(angle), 0.0};
        const Eigen::Vector3d half{uniform(random, 0.4, 3.5), uniform(random, 0.4, 3.5), uniform(random, 2.0, 9.0)};
        town.boxes.emplace_back(centre - half, centre + half);
      }
    }
    return town;
  }

  /// Metres along the ray to a box or the ground z = 0; infinity where there is nothing within 80 m.
  double range_m(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
    double range = direction.z() < 0.0 ? -from.z() / direction.z() : std::numeric_limits<double>::infinity();
    for (const Eigen::AlignedBox3d& box : boxes) {
      const Eigen::Array3d a = (box.min() - from).array() / direction.array();
      const Eigen::Array3d b = (box.max() - from).array() / direction.array();
      const double enter = a.min(b).maxCoeff();
      if (enter > 0.0 && enter < a.max(b).minCoeff()) range = std::min(range, enter);
    }
    return range < 80.0 ? range : std::numeric_limits<double>::infinity();
  }

  /// Sixteen rings of 2 degrees seen from T_map_base, with normal noise of the ranges.
  PointCloud scan(const Pose& T_map_base, Random& random, double sigma_m = 0.01) const {
    PointCloud points;
    const Eigen::Vector3d from = T_map_base * kLidarInBase;
    for (int ring = -8; ring < 8; ++ring) {
      const double elevation = (2.0 * ring + 1.0) * std::numbers::pi / 180.0;
      for (int step = 0; step < 360; ++step) {
        const double azimuth = step * std::numbers::pi / 180.0;
        const Eigen::Vector3d d_base{std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                     std::sin(elevation)};
        const double range = range_m(from, T_map_base.rotation * d_base);
        if (!std::isfinite(range)) continue;
        const Eigen::Vector3f p = (kLidarInBase + (range + normal(random, sigma_m)) * d_base).cast<float>();
        points.push_back({p.x(), p.y(), p.z(), 50.0F});
      }
    }
    return points;
  }
};

/// On the circle, heading along it; a little beside and turned in every lap.
inline Pose pose_on_circle(double radius_m, double along_m, double beside_m = 0.0) {
  const double angle = along_m / radius_m;
  const double r = radius_m + beside_m;
  return {Eigen::Quaterniond{Eigen::AngleAxisd{angle + std::numbers::pi / 2.0, Eigen::Vector3d::UnitZ()}},
          {r * std::cos(angle), r * std::sin(angle), 0.0}};
}

}  // namespace slamd::test
