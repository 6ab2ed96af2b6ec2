#pragma once
// What a laser beam asks of the world and what it gets back. No geometry here.

#include <Eigen/Core>
#include <limits>

namespace slamd::sim {

/// reflectivity        0..1 of a white Lambertian target; above 1: retro-reflector
/// porous_depth_m      0 = solid; else the mean depth at which a beam is returned inside the body (foliage)
struct Material {
  float reflectivity = 0.3F;
  float porous_depth_m = 0.0F;
};

namespace materials {
inline constexpr Material kAsphalt{0.17F}, kPavement{0.35F}, kGrass{0.25F}, kPlaster{0.65F}, kBrick{0.40F},
    kGlass{0.08F}, kConcrete{0.45F}, kRoof{0.25F}, kBark{0.30F}, kFoliage{0.45F, 0.30F}, kHedge{0.40F, 0.08F},
    kMetal{0.30F}, kCarPaint{0.40F}, kClothes{0.35F}, kSign{3.0F}, kWhiteWall{0.75F};
}  // namespace materials

/// World frame, metres; direction is unit.
struct Ray {
  Ray(const Eigen::Vector3d& from, const Eigen::Vector3d& towards, double max_range_m)
      : origin{from}, direction{towards}, inverse{towards.cwiseInverse()}, max_range{max_range_m} {}

  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
  Eigen::Vector3d inverse;  // 1 / direction, infinities allowed
  double max_range;
  double porosity_draw = 0.0;  // exponential variate: how many mean depths the beam enters porous bodies
};

struct Hit {
  double range = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // outwards, unit
  Material material;

  explicit operator bool() const { return range < std::numeric_limits<double>::infinity(); }
};

}  // namespace slamd::sim
