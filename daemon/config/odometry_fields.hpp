#pragma once
// The estimator's table of keys. Split from config_fields.cpp by length only.

#include <vector>

#include "daemon/config/field.hpp"
#include "estimator/odometry/lidar_inertial_odometry.hpp"

namespace slamd {

std::vector<Field> odometry_fields(OdometryConfig& config);

}  // namespace slamd
