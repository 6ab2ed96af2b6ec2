#include "estimator/grid/scan_normals.hpp"

#include <algorithm>
#include <cmath>

namespace slamd {
namespace {

constexpr float kReach_m = 0.15F;         // of neighbours
constexpr float kReachPerRange = 0.03F;   // beams are a degree apart at most: 1.7 neighbours to each side
constexpr float kMostReach_m = 1.0F;
constexpr std::size_t kMostNeighbours = 12;  // looked at, to each side
constexpr float kMostThickness = 0.3F;    // across over along
constexpr float kLeastNeighbours = 3.0F;

struct Moments {
  float count = 0.0F, x = 0.0F, y = 0.0F, xx = 0.0F, xy = 0.0F, yy = 0.0F;

  void add(const Eigen::Vector2f& d) {
    count += 1.0F;
    x += d.x();
    y += d.y();
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
};

Eigen::Vector2f normal_of(const Moments& m, const Eigen::Vector2f& to_lidar) {
  if (m.count < kLeastNeighbours) return Eigen::Vector2f::Zero();
  const float mx = m.x / m.count;
  const float my = m.y / m.count;
  const float cxx = m.xx / m.count - mx * mx;
  const float cxy = m.xy / m.count - mx * my;
  const float cyy = m.yy / m.count - my * my;
  const float half = 0.5F * (cxx - cyy);
  const float root = std::hypot(half, cxy);
  const float along = 0.5F * (cxx + cyy) + root;
  const float across = std::max(0.0F, 0.5F * (cxx + cyy) - root);
  if (across > kMostThickness * kMostThickness * along) return Eigen::Vector2f::Zero();
  const float angle = 0.5F * std::atan2(cxy, half);
  const Eigen::Vector2f normal{-std::sin(angle), std::cos(angle)};
  return normal.dot(to_lidar) < 0.0F ? Eigen::Vector2f{-normal} : normal;
}

void sort_by_direction(PlanarScan& scan) {
  const auto direction = [&](const Eigen::Vector2f& p) { return std::atan2(p.y() - scan.origin.y(), p.x() - scan.origin.x()); };
  std::ranges::stable_sort(scan.points, {}, direction);
}

}  // namespace

void find_normals(PlanarScan& scan, double spacing_m) {
  const float least_reach = std::max(kReach_m, 3.0F * static_cast<float>(spacing_m));
  sort_by_direction(scan);
  const std::size_t n = scan.points.size();
  const std::size_t sides = std::min(kMostNeighbours, n > 0 ? (n - 1) / 2 : 0);
  scan.normals.assign(n, Eigen::Vector2f::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2f& p = scan.points[i];
    const Eigen::Vector2f to_lidar = scan.origin - p;
    const float reach = std::min(least_reach + kReachPerRange * to_lidar.norm(), kMostReach_m);
    Moments moments;
    moments.add(Eigen::Vector2f::Zero());
    for (std::size_t k = 1; k <= sides; ++k) {
      for (const std::size_t j : {(i + k) % n, (i + n - k) % n}) {
        const Eigen::Vector2f d = scan.points[j] - p;
        if (d.squaredNorm() <= reach * reach) moments.add(d);
      }
    }
    scan.normals[i] = normal_of(moments, to_lidar);
  }
}

}  // namespace slamd
