#pragma once
// Composes bodies of buildings, trees, cars and street furniture on a ground. Knows shapes, not where they belong.

#include "tools/slam-sim/world/height_field.hpp"
#include "tools/slam-sim/world/primitive.hpp"
#include "tools/slam-sim/world/rng.hpp"

namespace slamd::sim {

/// half: footprint half extents in its own axes; height above the lowest ground under it.
struct BuildingPlan {
  Eigen::Vector2d centre;
  Eigen::Vector2d half;
  double yaw;
  double height_m;
  Material wall;
};

class SceneBuilder {
 public:
  SceneBuilder(HeightField& ground, std::uint64_t seed) : ground_{ground}, rng_{seed, Stream::kWorld} {}

  /// Body, pilasters, floor bands, window panes and a gabled or flat roof.
  void add_building(const BuildingPlan& plan);
  /// Trunk and porous crown, a deciduous ellipsoid or a conifer's cone.
  void add_tree(const Eigen::Vector2d& at);
  void add_pole(const Eigen::Vector2d& at, double yaw, bool sign);
  void add_car(const Eigen::Vector2d& at, double yaw);
  /// A box standing on the ground: hedge, wall, kerb, pillar. half: along, across, half height.
  void add_block(const Eigen::Vector2d& at, double yaw, const Eigen::Vector3d& half, Material material);
  void add(const Primitive& body) { bodies_.push_back(body); }

  Rng& rng() { return rng_; }
  std::vector<Primitive> take() { return std::move(bodies_); }

 private:
  double ground_at(const Eigen::Vector2d& at) const { return ground_.height(at.x(), at.y()); }
  void add_facade(const BuildingPlan& plan, double base, int side);
  void add_roof(const BuildingPlan& plan, double top);

  HeightField& ground_;
  Rng rng_;
  std::vector<Primitive> bodies_;
};

}  // namespace slamd::sim
