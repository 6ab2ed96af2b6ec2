#pragma once
// The solid bodies the world is built of, with exact ray intersection. Not a scene: world/bvh holds many of them.

#include <Eigen/Geometry>

#include "tools/slam-sim/world/ray.hpp"

namespace slamd::sim {

enum class Shape : std::uint8_t { kBox, kCylinder, kEllipsoid, kCone };

/// half: half extents in the body's frame. Cylinder and cone stand along z with radius half.x (cone: apex at +half.z).
struct Primitive {
  Shape shape = Shape::kBox;
  Material material;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d half = Eigen::Vector3d::Ones();
  Eigen::Matrix3d R_world_body = Eigen::Matrix3d::Identity();

  Eigen::AlignedBox3d bounds() const;
};

Primitive make_box(const Eigen::Vector3d& centre, const Eigen::Vector3d& half, double yaw, Material material);
Primitive make_upright(Shape shape, const Eigen::Vector3d& centre, const Eigen::Vector3d& half, Material material);

/// Shortens `hit` if the ray enters the body from outside nearer than hit.range. A ray that starts inside sees nothing
/// of that body. Porous bodies return the ray inside, or let it pass.
void intersect(const Primitive& body, const Ray& ray, Hit& hit);

}  // namespace slamd::sim
