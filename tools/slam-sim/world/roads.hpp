#pragma once
// Polylines of streets: corners rounded, shifted sideways, measured. Plan view only.

#include <functional>

#include "tools/slam-sim/world/world.hpp"

namespace slamd::sim {

using Warp = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

/// Corner points to a polyline with arcs of radius_m (less where the legs are short) and a point every step_m.
Polyline rounded(const Polyline& corners, bool closed, double radius_m, double step_m);
/// Shifted to the left of the driving direction (negative: right).
Polyline shifted(const Polyline& line, bool closed, double left_m);
Polyline warped(const Polyline& line, const Warp& warp);
/// Distance from p to the nearest segment of the line (the closing one included when closed), metres.
double distance_to(const Polyline& line, bool closed, const Eigen::Vector2d& p);

/// A place beside a street: where, and which way the street runs there.
struct RoadPlace {
  Eigen::Vector2d point;
  double yaw;
};
/// Places every spacing_m along the line, left_m to its left.
std::vector<RoadPlace> places_along(const Polyline& line, bool closed, double spacing_m, double left_m);

}  // namespace slamd::sim
