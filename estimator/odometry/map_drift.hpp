#pragma once
// How the local map drifts from odom's origin as the vehicle moves on: the part of the pose's uncertainty that the filter
// cannot see, because it takes its map for true. No estimate is changed here, only a covariance.

#include "estimator/filter/inertial_state.hpp"

namespace slamd {

/// A random walk in the distance driven, on top of what the first map's own tilt is worth. The figures are the drift of
/// this front end over 1-200 m of simulated and recorded drives (README.md), with a margin.
struct MapDriftConfig {
  double position_m_rtm = 8.0e-4;        // metres per root metre
  double attitude_rad_rtm = 1.5e-5;      // radians per root metre
  double first_tilt_rad = 6.0e-4;        // roll and pitch of a map begun at one place
  double first_heading_rad = 1.0e-4;
  double first_position_m = 2.0e-3;
  // Of a map begun while moving: its first scans are displaced and turned by what is wrong with the velocity.
  double moving_velocity_share = 0.02;   // scans alone tell a velocity to so much of itself
  double moving_skew_s = 0.3;            // and the map takes in the error for so long
  double moving_lever_m = 40.0;          // a displacement of so many metres turns it by a radian
};

/// Covariance of a map just begun at rest, rows as NavState::covariance.
Matrix6d first_drift(const MapDriftConfig& config);

/// What a map has beyond that when it was begun by a moving filter: its first scans are skewed by the errors of velocity and
/// rate. Rows as NavState::covariance.
Matrix6d skew_drift(const MapDriftConfig& config, const FilterSnapshot& filter);

/// Carries the drift over a move of base from T_odom_a to T_odom_b: an error of attitude at `a` displaces `b`, and the walk
/// adds its own. Rows as NavState::covariance.
Matrix6d carry_drift(const MapDriftConfig& config, const Matrix6d& drift, const Pose& T_odom_a, const Pose& T_odom_b);

}  // namespace slamd
