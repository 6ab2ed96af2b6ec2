#pragma once
// Where a PointCloud2 keeps what slamd needs, found by name and type, and its points as numbers. It knows no time and no sweep
// (cloud_timing.hpp).

#include <optional>
#include <vector>

#include "drivers/ros/messages.hpp"

namespace slamd::replay {

struct CloudPoint {
  float x, y, z;        // metres
  float intensity;
  double time;          // as sent; 0 without such a field
  std::uint8_t ring;    // of the field, or of the row of an organised cloud; 0 without either
};

struct CloudPoints {
  std::vector<CloudPoint> points;  // with a finite place that is not the origin, in the message's order
  bool has_ring = false;
  bool has_time = false;
};

/// At most so many points are kept of one cloud; of larger ones every n-th.
inline constexpr std::size_t kMostCloudPoints = 60'000;

/// Nothing for a cloud without x, y and z as floating-point numbers or whose sizes contradict each other.
std::optional<CloudPoints> read_points(const PointCloud2Message& cloud);

}  // namespace slamd::replay
