#pragma once
// The table of keys of planar SLAM. Split from config_fields.cpp by length only.

#include <vector>

#include "daemon/config/field.hpp"
#include "estimator/grid/slam_2d.hpp"

namespace slamd {

std::vector<Field> planar_fields(Slam2dConfig& config);

}  // namespace slamd
