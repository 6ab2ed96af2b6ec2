// Two blocks within a street, with buildings, trees, cars, poles and hedges: the campus of gently rolling ground, 900 m round,
// extensive grounds, 1.8 km round, and a hilly town, 3 km round.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/slam-sim/world/roads.hpp"
#include "tools/slam-sim/world/scene_builder.hpp"
#include "tools/slam-sim/world/terrain.hpp"

namespace slamd::sim {
namespace {

using Eigen::Vector2d;

struct Plan {
  double width_m, depth_m;  // of the outer street
  double hills_rms_m, shortest_hill_m, longest_hill_m;
  int lawn_trees;
};

constexpr Plan kCampus{312.0, 156.0, 0.9, 70.0, 260.0, 120};
constexpr Plan kGrounds{560.0, 363.0, 0.9, 90.0, 300.0, 350};
constexpr Plan kHills{1000.0, 500.0, 7.0, 250.0, 800.0, 600};

constexpr double kMargin = 75.0;
constexpr double kHalfRoad = 3.6;
constexpr double kLane = 1.75;

constexpr double kBent = 12.0;  // no street is so far from the straight lines of the plan

struct Streets {
  Plan plan;
  Polyline outer;
  Polyline middle;

  bool within(double reach_m, const Vector2d& p) const {
    if (from_plan(p) > reach_m + kBent) return false;
    return distance_to(outer, true, p) < reach_m || distance_to(middle, false, p) < reach_m;
  }

 private:
  double from_plan(const Vector2d& p) const {
    const double across = std::min({std::abs(p.x()), std::abs(p.x() - plan.width_m / 2), std::abs(p.x() - plan.width_m)});
    return std::min({across, std::abs(p.y()), std::abs(p.y() - plan.depth_m)});
  }
};

Warp bent_streets(Rng& rng) {
  const double a = rng.uniform(0.0, 6.28), b = rng.uniform(0.0, 6.28);
  return [a, b](const Vector2d& p) -> Vector2d {
    return {p.x() + 3.5 * std::sin(p.y() / 38.0 + a), p.y() + 4.5 * std::sin(p.x() / 52.0 + b)};
  };
}

Streets make_streets(const Plan& plan, const Warp& warp) {
  const double w = plan.width_m, d = plan.depth_m;
  const Polyline corners{{w / 2, 0}, {w, 0}, {w, d}, {0, d}, {0, 0}};
  return {plan, warped(rounded(corners, true, 14.0, 2.0), warp),
          warped(rounded({{w / 2, 0}, {w / 2, d}}, false, 1.0, 2.0), warp)};
}

/// Clockwise round the eastern block, anticlockwise round the western one; the middle street is driven twice
/// northwards.
Polyline eight_corners(const Plan& plan) {
  const double m = plan.width_m / 2, w = plan.width_m, d = plan.depth_m;
  return {{m, 0}, {m, d}, {w, d}, {w, 0}, {m, 0}, {m, d}, {0, d}, {0, 0}};
}

void build_blocks(SceneBuilder& scene, const Streets& streets) {
  Rng& rng = scene.rng();
  std::vector<BuildingPlan> placed;
  for (double y = -kMargin + 20; y < streets.plan.depth_m + kMargin; y += 36.0) {
    for (double x = -kMargin + 20; x < streets.plan.width_m + kMargin; x += 38.0) {
      const Vector2d centre(x + rng.uniform(-7, 7), y + rng.uniform(-7, 7));
      const Vector2d half(rng.uniform(7, 16), rng.uniform(5, 10));
      const double reach = half.norm();
      const bool clear = std::all_of(placed.begin(), placed.end(), [&](const BuildingPlan& other) {
        return (other.centre - centre).norm() > reach + other.half.norm() + 3.0;
      });
      if (!clear || streets.within(reach + 7.0, centre) || rng.chance(0.12)) continue;
      const Material wall = rng.chance(0.5) ? materials::kPlaster : materials::kBrick;
      placed.push_back({centre, half, rng.uniform(-0.25, 0.25), rng.uniform(5.5, 15.0), wall});
      scene.add_building(placed.back());
    }
  }
}

void furnish_street(SceneBuilder& scene, const Streets& streets, const Polyline& street, bool closed) {
  Rng& rng = scene.rng();
  const auto free = [&](const Vector2d& p, double clearance) { return !streets.within(clearance, p); };
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

void plant_lawn(SceneBuilder& scene, const Streets& streets) {
  Rng& rng = scene.rng();
  const double width = streets.plan.width_m, depth = streets.plan.depth_m;
  for (int i = 0; i < streets.plan.lawn_trees; ++i) {
    const Vector2d p(rng.uniform(-kMargin, width + kMargin), rng.uniform(-kMargin, depth + kMargin));
    if (!streets.within(kHalfRoad + 6.0, p)) scene.add_tree(p);
  }
}

World make_blocks(std::uint64_t seed, const Plan& plan) {
  const double width = plan.width_m, depth = plan.depth_m;
  Rng rng{seed, Stream::kWorld, 1};
  const Warp warp = bent_streets(rng);
  const Streets streets = make_streets(plan, warp);
  HeightField ground({-kMargin - 60, -kMargin - 60}, {width + kMargin + 60, depth + kMargin + 60}, 1.0,
                     rolling_hills(rng, plan.hills_rms_m, plan.shortest_hill_m, plan.longest_hill_m));
  ground.paint(materials::kPavement, [&](double x, double y) { return streets.within(kHalfRoad + 2.6, {x, y}); });
  ground.paint(materials::kAsphalt, [&](double x, double y) { return streets.within(kHalfRoad, {x, y}); });
  SceneBuilder scene{ground, seed};
  build_blocks(scene, streets);
  furnish_street(scene, streets, streets.outer, true);
  furnish_street(scene, streets, streets.middle, false);
  plant_lawn(scene, streets);
  const Polyline eight = warped(rounded(eight_corners(plan), true, 14.0, 2.0), warp);
  const Polyline block =
      warped(rounded({{80, 0}, {width / 2, 0}, {width / 2, depth}, {0, depth}, {0, 0}}, true, 14.0, 2.0), warp);
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

}  // namespace

World make_campus(std::uint64_t seed) { return make_blocks(seed, kCampus); }

World make_grounds(std::uint64_t seed) { return make_blocks(seed, kGrounds); }

World make_hills(std::uint64_t seed) { return make_blocks(seed, kHills); }

}  // namespace slamd::sim
