// Campus: two blocks of gently rolling ground within a street of 900 m, with buildings, trees, cars, poles and hedges.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/slam-sim/world/roads.hpp"
#include "tools/slam-sim/world/scene_builder.hpp"
#include "tools/slam-sim/world/terrain.hpp"

namespace slamd::sim {
namespace {

using Eigen::Vector2d;

constexpr double kWidth = 312.0, kDepth = 156.0;  // of the outer street
constexpr double kMargin = 75.0;
constexpr double kHalfRoad = 3.6;
constexpr double kLane = 1.75;

struct Streets {
  Polyline outer;
  Polyline middle;
  double distance(const Vector2d& p) const {
    return std::min(distance_to(outer, true, p), distance_to(middle, false, p));
  }
};

Warp bent_streets(Rng& rng) {
  const double a = rng.uniform(0.0, 6.28), b = rng.uniform(0.0, 6.28);
  return [a, b](const Vector2d& p) -> Vector2d {
    return {p.x() + 3.5 * std::sin(p.y() / 38.0 + a), p.y() + 4.5 * std::sin(p.x() / 52.0 + b)};
  };
}

Streets make_streets(const Warp& warp) {
  const Polyline corners{{kWidth / 2, 0}, {kWidth, 0}, {kWidth, kDepth}, {0, kDepth}, {0, 0}};
  return {warped(rounded(corners, true, 14.0, 2.0), warp),
          warped(rounded({{kWidth / 2, 0}, {kWidth / 2, kDepth}}, false, 1.0, 2.0), warp)};
}

/// Clockwise round the eastern block, anticlockwise round the western one; the middle street is driven twice
/// northwards.
Polyline eight_corners() {
  const double m = kWidth / 2;
  return {{m, 0}, {m, kDepth}, {kWidth, kDepth}, {kWidth, 0}, {m, 0}, {m, kDepth}, {0, kDepth}, {0, 0}};
}

void build_blocks(SceneBuilder& scene, const Streets& streets) {
  Rng& rng = scene.rng();
  std::vector<BuildingPlan> placed;
  for (double y = -kMargin + 20; y < kDepth + kMargin; y += 36.0) {
    for (double x = -kMargin + 20; x < kWidth + kMargin; x += 38.0) {
      const Vector2d centre(x + rng.uniform(-7, 7), y + rng.uniform(-7, 7));
      const Vector2d half(rng.uniform(7, 16), rng.uniform(5, 10));
      const double reach = half.norm();
      const bool clear = std::all_of(placed.begin(), placed.end(), [&](const BuildingPlan& other) {
        return (other.centre - centre).norm() > reach + other.half.norm() + 3.0;
      });
      if (!clear || streets.distance(centre) < reach + 7.0 || rng.chance(0.12)) continue;
      const Material wall = rng.chance(0.5) ? materials::kPlaster : materials::kBrick;
      placed.push_back({centre, half, rng.uniform(-0.25, 0.25), rng.uniform(5.5, 15.0), wall});
      scene.add_building(placed.back());
    }
  }
}

void furnish_street(SceneBuilder& scene, const Streets& streets, const Polyline& street, bool closed) {
  Rng& rng = scene.rng();
  const auto free = [&](const Vector2d& p, double clearance) { return streets.distance(p) > clearance; };
  for (const double side : {-1.0, 1.0}) {
    for (const RoadPlace& place : places_along(street, closed, 4.0, side * (kHalfRoad + 0.1))) {
      if (free(place.point, kHalfRoad))
        scene.add_block(place.point, place.yaw, {2.1, 0.08, 0.06}, materials::kConcrete);
    }
    for (const RoadPlace& place : places_along(street, closed, 6.5, side * (kHalfRoad + 1.4))) {
      if (rng.chance(0.28) && free(place.point, kHalfRoad + 1.2))
        scene.add_car(place.point, place.yaw + rng.uniform(-0.05, 0.05));
    }
    for (const RoadPlace& place : places_along(street, closed, 27.0, side * (kHalfRoad + 2.9))) {
      if (free(place.point, kHalfRoad + 2.0)) scene.add_pole(place.point, place.yaw, rng.chance(0.35));
    }
    for (const RoadPlace& place :
         places_along(street, closed, 13.0, side * (kHalfRoad + 5.0 + rng.uniform(0.0, 2.0)))) {
      if (rng.chance(0.6) && free(place.point, kHalfRoad + 3.5)) scene.add_tree(place.point);
    }
    for (const RoadPlace& place : places_along(street, closed, 24.0, side * (kHalfRoad + 9.0))) {
      if (!rng.chance(0.3) || !free(place.point, kHalfRoad + 6.0)) continue;
      const bool hedge = rng.chance(0.6);
      scene.add_block(place.point, place.yaw, {rng.uniform(3.0, 9.0), hedge ? 0.45 : 0.15, rng.uniform(0.4, 0.9)},
                      hedge ? materials::kHedge : materials::kBrick);
    }
  }
}

void plant_lawn(SceneBuilder& scene, const Streets& streets, int trees) {
  Rng& rng = scene.rng();
  for (int i = 0; i < trees; ++i) {
    const Vector2d p(rng.uniform(-kMargin, kWidth + kMargin), rng.uniform(-kMargin, kDepth + kMargin));
    if (streets.distance(p) > kHalfRoad + 6.0) scene.add_tree(p);
  }
}

}  // namespace

World make_campus(std::uint64_t seed) {
  Rng rng{seed, Stream::kWorld, 1};
  const Warp warp = bent_streets(rng);
  const Streets streets = make_streets(warp);
  HeightField ground({-kMargin - 60, -kMargin - 60}, {kWidth + kMargin + 60, kDepth + kMargin + 60}, 1.0,
                     rolling_hills(rng, 0.9, 70.0, 260.0));
  ground.paint(materials::kPavement, [&](double x, double y) { return streets.distance({x, y}) < kHalfRoad + 2.6; });
  ground.paint(materials::kAsphalt, [&](double x, double y) { return streets.distance({x, y}) < kHalfRoad; });
  SceneBuilder scene{ground, seed};
  build_blocks(scene, streets);
  furnish_street(scene, streets, streets.outer, true);
  furnish_street(scene, streets, streets.middle, false);
  plant_lawn(scene, streets, 120);
  const Polyline eight = warped(rounded(eight_corners(), true, 14.0, 2.0), warp);
  const Polyline block =
      warped(rounded({{80, 0}, {kWidth / 2, 0}, {kWidth / 2, kDepth}, {0, kDepth}, {0, 0}}, true, 14.0, 2.0), warp);
  const Polyline line(streets.outer.begin(), streets.outer.begin() + 60);
  return {.ground = std::move(ground),
          .bodies = Bvh{scene.take()},
          .loop = {shifted(streets.outer, true, -kLane), true},
          .short_loop = {shifted(block, true, -kLane), true},
          .figure_eight = {shifted(eight, true, -kLane), true},
          .line = {shifted(line, false, -kLane), false},
          .oncoming = {shifted(streets.outer, true, kLane), true},
          .pavement = {shifted(streets.outer, true, -(kHalfRoad + 2.3)), true}};
}

}  // namespace slamd::sim
