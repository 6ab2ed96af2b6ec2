#pragma once
// How the local map drifts from odom's origin as the vehicle moves on: the part of the pose's uncertainty that the filter
// cannot see, because it takes its map for true. No estimate is changed here, only a covariance.

#include "estimator/types/pose.hpp"

namespace slamd {

/// A random walk in the distance driven, on top of what the first map's own tilt is worth. The figures are the drift of
/// this front end over 1-200 m of simulated and recorded drives (README.md), with a margin.
struct MapDriftConfig {
  double position_m_rtm = 1.0e-3;        // metres per root metre
  double attitude_rad_rtm = 2.0e-5;      // radians per root metre
  double first_tilt_rad = 6.0e-4;        // roll and pitch of a map begun at one place
  double first_heading_rad = 1.0e-4;
  double first_position_m = 2.0e-3;
};

/// Covariance of a map just begun, rows as NavState::covariance.
Matrix6d first_drift(const MapDriftConfig& config);

/// Carries the drift over a move of base from T_odom_a to T_odom_b: an error of attitude at `a` displaces `b`, and the walk
/// adds its own. Rows as NavState::covariance.
Matrix6d carry_drift(const MapDriftConfig& config, const Matrix6d& drift, const Pose& T_odom_a, const Pose& T_odom_b);

}  // namespace slamd
