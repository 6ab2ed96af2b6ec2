#pragma once
// An occupancy grid as map_server of ROS and of nav2 read it: a PGM picture and a YAML file beside it, trinary. No reading.

#include <string>

#include "estimator/types/occupancy_grid.hpp"

namespace slamd {

/// Binary PGM (P5): the first row is the highest y; 0 occupied, 254 free, 205 unknown.
std::string grid_picture(const OccupancyGrid& grid);

/// What map_server needs besides: picture (a file name, relative to the YAML's folder), place and thresholds.
/// free_thresh is 0.196, so that the 205 of unknown stays unknown to every reader.
std::string grid_yaml(const OccupancyGrid& grid, const std::string& picture);

}  // namespace slamd
