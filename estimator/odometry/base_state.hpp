#pragma once
// The filter's state of the IMU told as the vehicle's: pose, twist and covariance of base. No status is decided here.

#include "estimator/filter/inertial_state.hpp"
#include "estimator/types/nav_state.hpp"

namespace slamd {

/// Pose, twist, biases and covariance of base at snapshot.time; status fields are left at their defaults.
NavState base_state(const FilterSnapshot& snapshot, const Pose& T_base_imu);

/// What the filter itself does not know of base's pose: relative to the map around, without the drift of that map. Rows as
/// NavState::covariance.
Matrix6d local_covariance(const FilterSnapshot& snapshot, const Pose& T_base_imu);

}  // namespace slamd
