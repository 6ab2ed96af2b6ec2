#include "estimator/graph/free_space.hpp"

#include <algorithm>

namespace slamd {

namespace {

constexpr float kMinPlanePoints = 12.0F;
constexpr float kSurfaceReach_m = 0.5F;  // a plane is taken as a surface so far from its centre

struct Ray {
  Eigen::Vector3f from, direction;
  float length_m = 0.0F;
};

/// The surface at p, crossed by the ray well away from both its ends.
bool crosses(const Plane& plane, const Ray& ray, const FreeSpaceConfig& config) {
  if (plane.points < kMinPlanePoints) return false;
  const float incidence = plane.normal.dot(ray.direction);
  if (std::abs(incidence) < config.min_incidence) return false;
  const float at_m = plane.normal.dot(plane.centre - ray.from) / incidence;
  if (at_m < config.margin_m || at_m > ray.length_m - config.margin_m) return false;
  return (ray.from + at_m * ray.direction - plane.centre).norm() < kSurfaceReach_m;
}

enum class Passage { kUnseen, kFree, kContradicted };

Passage walk(PlaneMap& target, const Ray& ray, const FreeSpaceConfig& config) {
  Passage passage = Passage::kUnseen;
  for (float s = config.margin_m; s < ray.length_m - config.margin_m; s += config.step_m) {
    const Plane* plane = target.plane_at(ray.from + s * ray.direction);
    if (plane == nullptr) continue;
    passage = Passage::kFree;
    if (crosses(*plane, ray, config)) return Passage::kContradicted;
  }
  return passage;
}

}  // namespace

FreeSpaceCheck check_free_space(PlaneMap& target, const Submap& source, const Pose& T_target_source,
                                const FreeSpaceConfig& config) {
  FreeSpaceCheck check;
  const std::size_t stride = source.points.size() / config.max_rays + 1;
  const Eigen::Matrix3f R = T_target_source.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_target_source.translation.cast<float>();
  std::size_t view = 0;
  for (std::size_t i = 0; i < source.points.size(); i += stride) {
    while (view + 1 < source.viewpoints.size() && source.first_points[view + 1] <= i) ++view;
    Ray ray{.from = R * source.viewpoints[view] + t, .direction = {}};
    const Eigen::Vector3f whole = R * source.points[i] + t - ray.from;
    ray.length_m = whole.norm();
    if (ray.length_m < 2.0F * config.margin_m) continue;
    ray.direction = whole / ray.length_m;
    const Passage passage = walk(target, ray, config);
    check.rays += passage != Passage::kUnseen ? 1 : 0;
    check.contradicted += passage == Passage::kContradicted ? 1 : 0;
  }
  return check;
}

}  // namespace slamd
