#pragma once
// A map of free and occupied squares as others read it: a picture with a place. How it was found out is estimator/grid's.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace slamd {

/// What a cell says, in ROS' numbers (nav_msgs/OccupancyGrid).
constexpr std::int8_t kUnknownCell = -1;
constexpr std::int8_t kFreeCell = 0;
constexpr std::int8_t kOccupiedCell = 100;

struct OccupancyGrid {
  double resolution_m = 0.05;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  // of the lower left corner of cell 0, in map; the grid is not turned
  std::uint32_t width = 0, height = 0;
  std::vector<std::int8_t> cells;                     // row by row from the lowest y; 100 occupied, 0 free, -1 unknown
};

}  // namespace slamd
