#pragma once
// Odom defined anew by the vehicle's present pose. Changes the frame that the state is told in, not what is known of it.

#include "estimator/filter/inertial_state.hpp"

namespace slamd {

/// From now on the IMU's pose in odom is exactly T_odom_imu, by definition: velocity, gravity and all errors are turned with
/// it, and what was unknown of the attitude is now unknown of velocity and gravity.
void define_odom(const Pose& T_odom_imu, FilterSnapshot& filter);

}  // namespace slamd
