// A house of two rows of rooms round a party wall, every room with a door to the next, furnished at random. For small robots.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "tools/slam-sim/world/roads.hpp"
#include "tools/slam-sim/world/scene_builder.hpp"

namespace slamd::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHeight = 2.5, kHalfWall = 0.06;
constexpr double kHalfDoor = 0.45, kDoorHeight = 2.05;
constexpr double kBend = 0.35;       // radius of the way's bends
constexpr double kClearance = 0.26;  // between the way and what stands beside it
constexpr Material kWood{0.45F}, kCloth{0.35F};

/// Where the walls stand and the doors in them: rooms are columns of two rows.
struct Rooms {
  std::vector<double> x;     // of the walls across, outer ones included
  std::array<double, 3> y;   // of the walls along: front, party wall, back
  std::vector<double> front_doors, back_doors;  // y of the door in inner wall x[i + 1], by row
  std::vector<std::optional<double>> middle_doors;  // x of the door between the rows, by column

  std::size_t columns() const { return x.size() - 1; }
  double far_x() const { return x.back(); }
};

Rooms draw_rooms(Rng& rng) {
  Rooms rooms;
  rooms.x.push_back(0.0);
  for (int columns = 3 + rng.index(2); columns > 0; --columns) rooms.x.push_back(rooms.x.back() + rng.uniform(3.2, 4.6));
  rooms.y = {0.0, rng.uniform(3.2, 4.2), 0.0};
  rooms.y[2] = rooms.y[1] + rng.uniform(3.2, 4.2);
  const auto door = [&](double from, double to) { return rng.uniform(from + 0.9, to - 0.9); };
  for (std::size_t wall = 1; wall < rooms.columns(); ++wall) {
    rooms.front_doors.push_back(door(rooms.y[0], rooms.y[1]));
    rooms.back_doors.push_back(door(rooms.y[1], rooms.y[2]));
  }
  for (std::size_t column = 0; column < rooms.columns(); ++column) {
    const bool needed = column == 0 || column + 1 == rooms.columns();  // by the way round
    const double x = rng.uniform(rooms.x[column] + 1.3, rooms.x[column + 1] - 1.3);
    rooms.middle_doors.push_back(needed || rng.chance(0.5) ? std::optional{x} : std::nullopt);
  }
  return rooms;
}

/// A wall from one point to another, axis-parallel, with a door that far along it.
void add_wall(SceneBuilder& scene, const Vector2d& from, const Vector2d& to, std::optional<double> door_m) {
  const Vector2d along = (to - from).normalized();
  const double yaw = std::atan2(along.y(), along.x()), length = (to - from).norm();
  const auto piece = [&](double begin, double end, double bottom, double top) {
    const Vector2d middle = from + along * (0.5 * (begin + end));
    scene.add(make_box({middle.x(), middle.y(), 0.5 * (bottom + top)}, {0.5 * (end - begin), kHalfWall, 0.5 * (top - bottom)}, yaw,
                       materials::kWhiteWall));
  };
  if (!door_m) {
    piece(-kHalfWall, length + kHalfWall, -0.1, kHeight);
    return;
  }
  piece(0.0, *door_m - kHalfDoor, -0.1, kHeight);
  piece(*door_m + kHalfDoor, length, -0.1, kHeight);
  piece(*door_m - kHalfDoor, *door_m + kHalfDoor, kDoorHeight, kHeight);
}

void build_walls(SceneBuilder& scene, const Rooms& rooms) {
  const double width = rooms.far_x(), depth = rooms.y[2];
  add_wall(scene, {0, 0}, {width, 0}, std::nullopt);
  add_wall(scene, {0, depth}, {width, depth}, std::nullopt);
  add_wall(scene, {0, 0}, {0, depth}, std::nullopt);
  add_wall(scene, {width, 0}, {width, depth}, std::nullopt);
  for (std::size_t i = 0; i < rooms.front_doors.size(); ++i) {
    const double x = rooms.x[i + 1];
    add_wall(scene, {x, rooms.y[0]}, {x, rooms.y[1]}, rooms.front_doors[i] - rooms.y[0]);
    add_wall(scene, {x, rooms.y[1]}, {x, rooms.y[2]}, rooms.back_doors[i] - rooms.y[1]);
  }
  for (std::size_t column = 0; column < rooms.columns(); ++column) {
    const auto& door = rooms.middle_doors[column];
    const double from = rooms.x[column];
    add_wall(scene, {from, rooms.y[1]}, {rooms.x[column + 1], rooms.y[1]}, door ? std::optional{*door - from} : std::nullopt);
  }
  scene.add(make_box({0.5 * width, 0.5 * depth, kHeight + 0.1}, {0.5 * width, 0.5 * depth, 0.1}, 0.0, materials::kWhiteWall));
}

/// Corners of the way through a row of rooms: a step before and a step after every door.
void append_row(Polyline& way, const Rooms& rooms, bool front, bool eastwards) {
  const std::vector<double>& doors = front ? rooms.front_doors : rooms.back_doors;
  const double step = eastwards ? 0.45 : -0.45;
  for (std::size_t i = 0; i < doors.size(); ++i) {
    const std::size_t wall = eastwards ? i : doors.size() - 1 - i;
    way.emplace_back(rooms.x[wall + 1] - step, doors[wall]);
    way.emplace_back(rooms.x[wall + 1] + step, doors[wall]);
  }
}

/// Through every room once, anticlockwise. It begins in the middle of the second room.
Polyline ring_way(const Rooms& rooms) {
  const double east = *rooms.middle_doors.back(), west = *rooms.middle_doors.front();
  Polyline way;
  append_row(way, rooms, true, true);
  way.emplace_back(east, rooms.front_doors.back());
  way.emplace_back(east, rooms.back_doors.back());
  append_row(way, rooms, false, false);
  way.emplace_back(west, rooms.back_doors.front());
  way.emplace_back(west, rooms.front_doors.front());
  std::rotate(way.begin(), way.begin() + 2, way.end());
  way.insert(way.begin(), Vector2d(0.5 * (way.front() + way.back())));
  return way;
}

/// A piece of furniture's place on the floor.
struct Footprint {
  Vector2d centre;
  Vector2d half;
  double yaw;
};

double distance_to(const Footprint& place, const Vector2d& p) {
  const Vector2d local = Eigen::Rotation2Dd(-place.yaw) * (p - place.centre);
  return (local.cwiseAbs() - place.half).cwiseMax(0.0).norm();
}

class Furnisher {
 public:
  Furnisher(SceneBuilder& scene, const Rooms& rooms, const Polyline& way) : scene_{scene}, rooms_{rooms}, way_{way} {}

  /// Things along the walls first, then what stands free.
  void furnish(const Vector2d& low, const Vector2d& high) {
    for (int i = 0; i < 5; ++i) put_by_wall(low, high);
    for (int i = 0; i < 4; ++i) put_free(low, high);
  }

 private:
  bool free(const Footprint& place) const {
    const auto clear_of_way = [&](const Vector2d& p) { return distance_to(place, p) > kClearance; };
    const auto clear_of = [&](const Footprint& other) { return (other.centre - place.centre).norm() > other.half.norm() + place.half.norm(); };
    return std::all_of(way_.begin(), way_.end(), clear_of_way) && std::all_of(placed_.begin(), placed_.end(), clear_of) && clear_of_doors(place);
  }

  bool clear_of_doors(const Footprint& place) const {
    for (std::size_t i = 0; i < rooms_.middle_doors.size(); ++i) {
      if (rooms_.middle_doors[i] && distance_to(place, {*rooms_.middle_doors[i], rooms_.y[1]}) < 0.7) return false;
    }
    return true;
  }

  void put_by_wall(const Vector2d& low, const Vector2d& high) {
    Rng& rng = scene_.rng();
    const Vector3d half(rng.uniform(0.3, 0.9), rng.uniform(0.18, 0.4), rng.uniform(0.2, 1.0));
    const int side = rng.index(4);
    const bool across = side >= 2;  // along a wall that runs in y
    const double depth = half.y() + rng.uniform(0.01, 0.06), share = rng.uniform();
    const double room = across ? high.y() - low.y() : high.x() - low.x();
    const double along = half.x() + share * (room - 2 * half.x());
    const Vector2d at = across ? Vector2d(side == 2 ? low.x() + depth : high.x() - depth, low.y() + along)
                               : Vector2d(low.x() + along, side == 0 ? low.y() + depth : high.y() - depth);
    const Footprint place{at, half.head<2>(), across ? std::numbers::pi / 2 : 0.0};
    if (!free(place)) return;
    placed_.push_back(place);
    scene_.add_block(at, place.yaw, half, rng.chance(0.5) ? kWood : kCloth);
  }

  void put_free(const Vector2d& low, const Vector2d& high) {
    Rng& rng = scene_.rng();
    const Vector2d at(rng.uniform(low.x() + 0.3, high.x() - 0.3), rng.uniform(low.y() + 0.3, high.y() - 0.3));
    const int kind = rng.index(3);
    const double yaw = rng.uniform(0.0, std::numbers::pi);
    const Vector2d half = kind == 0 ? Vector2d(rng.uniform(0.4, 0.8), rng.uniform(0.35, 0.5))
                                    : Vector2d::Constant(kind == 1 ? 0.22 : rng.uniform(0.1, 0.2));
    const Footprint place{at, half, yaw};
    if (!free(place)) return;
    placed_.push_back(place);
    kind == 2 ? add_pot(place) : add_on_legs(place, kind == 0 ? 0.74 : 0.45);
  }

  void add_pot(const Footprint& place) {
    const double r = place.half.x();
    scene_.add(make_upright(Shape::kCylinder, {place.centre.x(), place.centre.y(), 0.25}, {r, r, 0.25}, materials::kBrick));
  }

  /// A table or a chair: a plate on four round legs, which is all that a low LiDAR sees of it.
  void add_on_legs(const Footprint& place, double height) {
    constexpr double kLeg = 0.025;
    const Eigen::Rotation2Dd turn{place.yaw};
    for (const Vector2d& corner : {Vector2d(1, 1), Vector2d(1, -1), Vector2d(-1, 1), Vector2d(-1, -1)}) {
      const Vector2d at = place.centre + turn * Vector2d(corner.cwiseProduct(place.half - Vector2d::Constant(kLeg)));
      scene_.add(make_upright(Shape::kCylinder, {at.x(), at.y(), height / 2}, {kLeg, kLeg, height / 2}, kWood));
    }
    scene_.add(make_box({place.centre.x(), place.centre.y(), height}, {place.half.x(), place.half.y(), 0.02}, place.yaw, kWood));
  }

  SceneBuilder& scene_;
  const Rooms& rooms_;
  const Polyline& way_;
  std::vector<Footprint> placed_;
};

void furnish_rooms(SceneBuilder& scene, const Rooms& rooms, const Polyline& way) {
  Furnisher furnisher{scene, rooms, way};
  for (std::size_t column = 0; column < rooms.columns(); ++column) {
    for (const std::size_t row : {0, 1}) {
      const Vector2d wall = Vector2d::Constant(kHalfWall);
      furnisher.furnish(Vector2d(rooms.x[column], rooms.y[row]) + wall, Vector2d(rooms.x[column + 1], rooms.y[row + 1]) - wall);
    }
  }
}

}  // namespace

World make_house(std::uint64_t seed) {
  Rng rng{seed, Stream::kWorld, 1};
  const Rooms rooms = draw_rooms(rng);
  HeightField ground({-3.0, -3.0}, {rooms.far_x() + 3.0, rooms.y[2] + 3.0}, 1.0, [](double, double) { return 0.0; });
  ground.paint(kWood, [](double, double) { return true; });
  SceneBuilder scene{ground, seed};
  build_walls(scene, rooms);
  const Polyline way = rounded(ring_way(rooms), true, kBend, 0.05);
  furnish_rooms(scene, rooms, way);
  const Route ring{way, true};
  const Polyline::const_iterator end = way.begin() + static_cast<std::ptrdiff_t>(way.size() / 4);
  return {.ground = std::move(ground),
          .bodies = Bvh{scene.take()},
          .loop = ring,
          .short_loop = ring,
          .figure_eight = ring,
          .line = {Polyline(way.begin(), end), false},
          .oncoming = ring,
          .pavement = ring,
          .speed_limit_mps = 0.22};
}

}  // namespace slamd::sim
