// Worlds without a sky: a corridor that looks the same all along, and a parking house that repeats itself.

#include <algorithm>

#include "tools/slam-sim/world/roads.hpp"
#include "tools/slam-sim/world/scene_builder.hpp"

namespace slamd::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A horizontal slab, its lower face at z.
Primitive slab(const Vector2d& low, const Vector2d& high, double z, Material material) {
  const Vector2d centre = 0.5 * (low + high), half = 0.5 * (high - low);
  return make_box({centre.x(), centre.y(), z + 0.2}, {half.x(), half.y(), 0.2}, 0.0, material);
}

/// Four walls around a hall, faces inwards at low and high.
void add_walls(SceneBuilder& scene, const Vector2d& low, const Vector2d& high, double height, Material material) {
  const Vector2d centre = 0.5 * (low + high), half = 0.5 * (high - low);
  constexpr double kThick = 0.2;
  for (const double side : {-1.0, 1.0}) {
    const double y = centre.y() + side * (half.y() + kThick), x = centre.x() + side * (half.x() + kThick);
    scene.add(make_box({centre.x(), y, height / 2}, {half.x() + 2 * kThick, kThick, height / 2 + 0.2}, 0.0, material));
    scene.add(make_box({x, centre.y(), height / 2}, {kThick, half.y(), height / 2 + 0.2}, 0.0, material));
  }
}

HeightField flat_ground(const Vector2d& low, const Vector2d& high, Material material) {
  HeightField ground(low, high, 1.0, [](double, double) { return 0.0; });
  ground.paint(material, [](double, double) { return true; });
  return ground;
}

Polyline straight(const Vector2d& from, const Vector2d& to) {
  return rounded({from, to}, false, 1.0, 2.0);
}

}  // namespace

/// Driven from x = 0 to 120; the end walls stand 150 m further, beyond the LiDAR's reach.
World make_corridor(std::uint64_t seed) {
  const Vector2d low(-150.0, -2.6), high(270.0, 2.6);
  HeightField ground = flat_ground({-160.0, -10.0}, {280.0, 10.0}, materials::kPavement);
  SceneBuilder scene{ground, seed};
  constexpr double kHeight = 3.2;
  add_walls(scene, low, high, kHeight, materials::kWhiteWall);
  scene.add(slab(low, high, kHeight, materials::kWhiteWall));
  const Route line{straight({0.0, 0.0}, {120.0, 0.0}), false};
  const Route walkway{straight({-40.0, 1.9}, {200.0, 1.9}), false};
  return {.ground = std::move(ground),
          .bodies = Bvh{scene.take()},
          .loop = line,
          .short_loop = line,
          .figure_eight = line,
          .line = line,
          .oncoming = walkway,
          .pavement = walkway,
          .speed_limit_mps = 3.0};
}

World make_parking(std::uint64_t seed) {
  constexpr double kHeight = 2.9, kGrid = 7.8;
  const Vector2d low(-8.0, -8.0), high(86.0, 54.4);
  HeightField ground = flat_ground({-16.0, -16.0}, {96.0, 64.0}, materials::kConcrete);
  SceneBuilder scene{ground, seed};
  add_walls(scene, low, high, kHeight, materials::kConcrete);
  scene.add(slab(low, high, kHeight, materials::kConcrete));
  const Polyline lane = rounded({{20, 0}, {78, 0}, {78, 46.8}, {0, 46.8}, {0, 0}}, true, 5.0, 1.0);
  const Polyline cross = straight({39.0, 0.0}, {39.0, 46.8});
  const auto clear = [&](const Vector2d& p, double reach) {
    return distance_to(lane, true, p) > reach && distance_to(cross, false, p) > reach;
  };
  for (double y = low.y() + 4.1; y < high.y(); y += kGrid) {
    for (double x = low.x() + 4.1; x < high.x(); x += kGrid) {
      if (clear({x, y}, 2.2)) scene.add_block({x, y}, 0.0, {0.3, 0.3, kHeight / 2}, materials::kConcrete);
    }
    scene.add(make_box({39.0, y, kHeight - 0.15}, {47.0, 0.2, 0.15}, 0.0, materials::kConcrete));  // a beam
  }
  for (double y = 7.8; y < 42.0; y += 7.8) {
    for (double x = 6.5; x < 74.0; x += 2.6) {
      if (clear({x, y}, 4.6) && scene.rng().chance(0.55)) scene.add_car({x, y}, 1.5708);
    }
  }
  const Route loop{lane, true};
  const Route eight{
      rounded({{39, 0}, {39, 46.8}, {78, 46.8}, {78, 0}, {39, 0}, {39, 46.8}, {0, 46.8}, {0, 0}}, true, 5.0, 1.0),
      true};
  const Route line{straight({4.0, 0.0}, {74.0, 0.0}), false};
  return {.ground = std::move(ground),
          .bodies = Bvh{scene.take()},
          .loop = loop,
          .short_loop = loop,
          .figure_eight = eight,
          .line = line,
          .oncoming = {shifted(lane, true, 2.2), true},
          .pavement = {shifted(lane, true, -2.2), true},
          .speed_limit_mps = 4.0};
}

}  // namespace slamd::sim
