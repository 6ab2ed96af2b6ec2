#include "tools/slam-sim/world/scene_builder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamd::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFloorHeight = 3.2;
constexpr double kFoundation = 3.0;  // bodies reach this far into the ground, so that slopes show no gap

Vector3d at_height(const Vector2d& p, double z) {
  return {p.x(), p.y(), z};
}

}  // namespace

void SceneBuilder::add_block(const Vector2d& at, double yaw, const Vector3d& half, Material material) {
  const double sunk = 0.3;
  const Vector3d reach(half.x(), half.y(), half.z() + sunk / 2);
  bodies_.push_back(make_box(at_height(at, ground_at(at) + half.z() - sunk / 2), reach, yaw, material));
}

void SceneBuilder::add_building(const BuildingPlan& plan) {
  const Eigen::Rotation2Dd turn(plan.yaw);
  double base = ground_at(plan.centre);
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      base = std::min(base, ground_at(plan.centre + turn * Vector2d(sx * plan.half.x(), sy * plan.half.y())));
    }
  }
  const double half_z = (plan.height_m + kFoundation) / 2;
  bodies_.push_back(make_box(at_height(plan.centre, base + plan.height_m - half_z),
                             {plan.half.x(), plan.half.y(), half_z}, plan.yaw, plan.wall));
  for (int side = 0; side < 4; ++side) add_facade(plan, base, side);
  add_roof(plan, base + plan.height_m);
}

void SceneBuilder::add_facade(const BuildingPlan& plan, double base, int side) {
  const double length = 2 * (side % 2 == 0 ? plan.half.x() : plan.half.y());
  const double depth = side % 2 == 0 ? plan.half.y() : plan.half.x();
  const double yaw = plan.yaw + side * std::numbers::pi / 2;
  const Eigen::Rotation2Dd turn(yaw);
  const auto place = [&](double along, double out, double z) {
    return at_height(plan.centre + turn * Vector2d(along, -(depth + out)), z);
  };
  const int bays = std::max(2, static_cast<int>(length / rng_.uniform(3.5, 6.0)));
  const double bay = length / bays;
  const double relief = rng_.uniform(0.12, 0.4);
  const double pier_half = rng_.uniform(0.2, 0.45);
  for (int i = 0; i <= bays; ++i) {
    bodies_.push_back(make_box(place(-length / 2 + i * bay, 0.0, base + plan.height_m / 2),
                               {pier_half, relief, plan.height_m / 2}, yaw, plan.wall));
  }
  const int floors = static_cast<int>(plan.height_m / kFloorHeight);
  for (int floor = 1; floor <= floors; ++floor) {
    bodies_.push_back(
        make_box(place(0.0, 0.0, base + floor * kFloorHeight), {length / 2, relief * 0.6, 0.12}, yaw, plan.wall));
  }
  for (int floor = 0; floor < std::min(floors, 3); ++floor) {
    for (int i = 0; i < bays; ++i) {
      if (!rng_.chance(0.7)) continue;
      bodies_.push_back(make_box(place(-length / 2 + (i + 0.5) * bay, 0.0, base + (floor + 0.55) * kFloorHeight),
                                 {bay * 0.28, 0.03, 0.7}, yaw, materials::kGlass));
    }
  }
}

void SceneBuilder::add_roof(const BuildingPlan& plan, double top) {
  if (plan.height_m > 12.0 || rng_.chance(0.4)) {  // flat, with a parapet's worth of overhang and a technical box
    bodies_.push_back(make_box(at_height(plan.centre, top + 0.2), {plan.half.x() + 0.4, plan.half.y() + 0.4, 0.2},
                               plan.yaw, materials::kRoof));
    bodies_.push_back(make_box(at_height(plan.centre, top + 1.2), {plan.half.x() * 0.3, plan.half.y() * 0.3, 1.0},
                               plan.yaw, materials::kMetal));
    return;
  }
  const double tilt = rng_.uniform(0.4, 0.7);
  const double half_slope = (plan.half.y() + 0.5) / (2 * std::cos(tilt));
  for (const double side : {-1.0, 1.0}) {
    Primitive slope = make_box(Vector3d::Zero(), {plan.half.x() + 0.4, half_slope, 0.1}, plan.yaw, materials::kRoof);
    const Vector2d offset = Eigen::Rotation2Dd(plan.yaw) * Vector2d(0.0, side * half_slope * std::cos(tilt));
    slope.centre = at_height(plan.centre + offset, top + half_slope * std::sin(tilt));
    slope.R_world_body = slope.R_world_body * Eigen::AngleAxisd(-side * tilt, Vector3d::UnitX()).toRotationMatrix();
    bodies_.push_back(slope);
  }
}

void SceneBuilder::add_tree(const Vector2d& at) {
  const double base = ground_at(at);
  const double trunk = rng_.uniform(1.8, 3.2);
  const double radius = rng_.uniform(0.12, 0.28);
  const double crown = rng_.uniform(1.4, 2.8);
  const bool conifer = rng_.chance(0.3);
  const double crown_half = conifer ? rng_.uniform(2.0, 4.0) : crown * rng_.uniform(0.8, 1.3);
  const double trunk_half = (trunk + crown_half) / 2;
  bodies_.push_back(make_upright(Shape::kCylinder, at_height(at, base + trunk_half - 0.2),
                                 {radius, radius, trunk_half + 0.2}, materials::kBark));
  const double crown_base = conifer ? 0.6 * trunk : trunk;
  bodies_.push_back(make_upright(conifer ? Shape::kCone : Shape::kEllipsoid,
                                 at_height(at, base + crown_base + crown_half), {crown, crown, crown_half},
                                 materials::kFoliage));
}

void SceneBuilder::add_pole(const Vector2d& at, double yaw, bool sign) {
  const double base = ground_at(at);
  const double height = sign ? 2.6 : rng_.uniform(5.0, 7.0);
  bodies_.push_back(make_upright(Shape::kCylinder, at_height(at, base + height / 2),
                                 {sign ? 0.04 : 0.09, 0.09, height / 2}, materials::kMetal));
  const Material head = sign ? materials::kSign : materials::kMetal;
  const Vector3d half = sign ? Vector3d(0.02, 0.35, 0.35) : Vector3d(0.5, 0.12, 0.08);
  bodies_.push_back(make_box(at_height(at, base + height), half, yaw, head));
}

void SceneBuilder::add_car(const Vector2d& at, double yaw) {
  const double base = ground_at(at);
  const double half_length = rng_.uniform(1.9, 2.4);
  const Material paint{static_cast<float>(rng_.uniform(0.08, 0.7))};
  bodies_.push_back(make_box(at_height(at, base + 0.58), {half_length, 0.88, 0.36}, yaw, paint));
  const Vector2d cabin = at + Eigen::Rotation2Dd(yaw) * Vector2d(-0.25, 0.0);
  bodies_.push_back(make_box(at_height(cabin, base + 1.2), {half_length * 0.52, 0.78, 0.27}, yaw, materials::kGlass));
  for (const double along : {-0.62, 0.62}) {
    const Vector2d axle = at + Eigen::Rotation2Dd(yaw) * Vector2d(along * half_length, 0.0);
    bodies_.push_back(make_box(at_height(axle, base + 0.15), {0.3, 0.85, 0.25}, yaw, Material{0.06F}));
  }
}

}  // namespace slamd::sim
