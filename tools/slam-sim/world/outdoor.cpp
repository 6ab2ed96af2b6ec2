// Worlds under the sky beside the campus: a field with little to see, and a street canyon.

#include <algorithm>

#include "tools/slam-sim/world/roads.hpp"
#include "tools/slam-sim/world/scene_builder.hpp"
#include "tools/slam-sim/world/terrain.hpp"

namespace slamd::sim {
namespace {

using Eigen::Vector2d;

Polyline eight_through_middle(double width, double depth, double radius) {
  const double m = width / 2;
  return rounded({{m, 0}, {m, depth}, {width, depth}, {width, 0}, {m, 0}, {m, depth}, {0, depth}, {0, 0}}, true, radius,
                 2.0);
}

/// Houses wall to wall along both sides of a street, with a gap where another street opens.
void line_with_houses(SceneBuilder& scene, const Polyline& street,
                      const std::function<double(const Vector2d&)>& to_street) {
  Rng& rng = scene.rng();
  constexpr double kFront = 9.5, kDepth = 6.0;
  for (const double side : {-1.0, 1.0}) {
    for (const RoadPlace& place : places_along(street, true, 15.0, side * (kFront + kDepth))) {
      const Vector2d half(7.4, kDepth + rng.uniform(-0.6, 0.4));
      if (to_street(place.point) < kFront + kDepth - 1.0) continue;
      const Material wall = rng.chance(0.5) ? materials::kPlaster : materials::kBrick;
      scene.add_building({place.point, half, place.yaw, rng.uniform(12.0, 24.0), wall});
    }
  }
}

void furnish(SceneBuilder& scene, const Polyline& street, const std::function<double(const Vector2d&)>& to_street) {
  Rng& rng = scene.rng();
  for (const double side : {-1.0, 1.0}) {
    for (const RoadPlace& place : places_along(street, true, 6.2, side * 5.0)) {
      if (rng.chance(0.6) && to_street(place.point) > 4.7) scene.add_car(place.point, place.yaw);
    }
    for (const RoadPlace& place : places_along(street, true, 25.0, side * 7.0)) {
      if (to_street(place.point) > 6.0) scene.add_pole(place.point, place.yaw, rng.chance(0.4));
    }
    for (const RoadPlace& place : places_along(street, true, 4.0, side * 6.1)) {
      if (to_street(place.point) > 5.5)
        scene.add_block(place.point, place.yaw, {2.0, 0.08, 0.07}, materials::kConcrete);
    }
  }
}

}  // namespace

World make_urban(std::uint64_t seed) {
  constexpr double kWidth = 240.0, kDepth = 130.0, kMargin = 90.0;
  Rng rng{seed, Stream::kWorld, 1};
  const Polyline outer =
      rounded({{kWidth / 2, 0}, {kWidth, 0}, {kWidth, kDepth}, {0, kDepth}, {0, 0}}, true, 10.0, 2.0);
  const Polyline middle = rounded({{kWidth / 2, 0}, {kWidth / 2, kDepth}}, false, 1.0, 2.0);
  const auto to_street = [&](const Vector2d& p) {
    return std::min(distance_to(outer, true, p), distance_to(middle, false, p));
  };
  HeightField ground({-kMargin, -kMargin}, {kWidth + kMargin, kDepth + kMargin}, 1.0,
                     rolling_hills(rng, 0.5, 90.0, 300.0));
  ground.paint(materials::kPavement, [](double, double) { return true; });
  ground.paint(materials::kAsphalt, [&](double x, double y) { return to_street({x, y}) < 6.0; });
  SceneBuilder scene{ground, seed};
  line_with_houses(scene, outer, to_street);
  furnish(scene, outer, to_street);
  const Polyline line(outer.begin(), outer.begin() + 45);
  return {.ground = std::move(ground),
          .bodies = Bvh{scene.take()},
          .loop = {shifted(outer, true, -1.75), true},
          .short_loop = {shifted(outer, true, -1.75), true},
          .figure_eight = {shifted(eight_through_middle(kWidth, kDepth, 10.0), true, -1.75), true},
          .line = {shifted(line, false, -1.75), false},
          .oncoming = {shifted(outer, true, 1.75), true},
          .pavement = {shifted(outer, true, -7.8), true}};
}

World make_open_field(std::uint64_t seed) {
  constexpr double kWidth = 260.0, kDepth = 140.0, kMargin = 160.0;
  Rng rng{seed, Stream::kWorld, 1};
  const Polyline track =
      rounded({{kWidth / 2, 0}, {kWidth, 15}, {kWidth - 20, kDepth}, {10, kDepth - 20}, {0, 10}}, true, 25.0, 2.0);
  HeightField ground({-kMargin, -kMargin}, {kWidth + kMargin, kDepth + kMargin}, 1.0,
                     rolling_hills(rng, 1.3, 45.0, 200.0));
  ground.paint(materials::kAsphalt, [&](double x, double y) { return distance_to(track, true, {x, y}) < 2.5; });
  SceneBuilder scene{ground, seed};
  for (int i = 0; i < 60; ++i) {
    const Vector2d p(scene.rng().uniform(-100.0, kWidth + 100.0), scene.rng().uniform(-100.0, kDepth + 100.0));
    if (distance_to(track, true, p) > 6.0) scene.add_tree(p);
  }
  for (const RoadPlace& place : places_along(track, true, 50.0, 4.0)) scene.add_pole(place.point, place.yaw, false);
  const Polyline line(track.begin(), track.begin() + 50);
  return {.ground = std::move(ground),
          .bodies = Bvh{scene.take()},
          .loop = {track, true},
          .short_loop = {track, true},
          .figure_eight = {eight_through_middle(kWidth, kDepth, 25.0), true},
          .line = {line, false},
          .oncoming = {shifted(track, true, 3.0), true},
          .pavement = {shifted(track, true, -4.0), true},
          .speed_limit_mps = 7.0};
}

}  // namespace slamd::sim
