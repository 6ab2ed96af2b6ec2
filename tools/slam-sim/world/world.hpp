#pragma once
// A finished world: ground, static bodies and the routes one may drive. Moving objects are in motion/traffic.

#include <string>
#include <vector>

#include "tools/slam-sim/world/bvh.hpp"
#include "tools/slam-sim/world/height_field.hpp"

namespace slamd::sim {

using Polyline = std::vector<Eigen::Vector2d>;

/// Dense centre line (a point every few metres), world frame. Closed: the last point precedes the first.
struct Route {
  Polyline points;
  bool closed = false;
};

struct World {
  HeightField ground;
  Bvh bodies;
  Route loop;          // the ego lane round the world
  Route short_loop;    // a smaller round, for several laps
  Route figure_eight;  // the same lanes, crossing in the middle
  Route line;          // one straight stretch, to be driven there and back
  Route oncoming;      // opposite lane of the loop, driven against it
  Route pavement;      // where pedestrians walk
  double speed_limit_mps = 8.0;

  Hit cast(const Ray& ray) const {
    Hit hit;
    ground.cast(ray, hit);
    bodies.cast(ray, hit);
    return hit;
  }
};

enum class WorldKind { kCampus, kCorridor, kParking, kOpenField, kUrban, kHills, kGrounds, kHouse };

/// Procedural and repeatable: the same kind and seed give the same world. Throws nothing; takes up to a second.
World make_world(WorldKind kind, std::uint64_t seed);

World make_campus(std::uint64_t seed);
World make_hills(std::uint64_t seed);
World make_grounds(std::uint64_t seed);
World make_house(std::uint64_t seed);
World make_corridor(std::uint64_t seed);
World make_parking(std::uint64_t seed);
World make_open_field(std::uint64_t seed);
World make_urban(std::uint64_t seed);

}  // namespace slamd::sim
