#pragma once
// How the local map drifts from odom's origin as the vehicle moves on: the part of the pose's uncertainty that the filter
// cannot see, because it takes its map for true. No estimate is changed here, only a covariance.

#include "estimator/filter/inertial_state.hpp"

namespace slamd {

/// What is around the vehicle was put into the map by poses that were unsure themselves: within renewal_m the map takes on
/// the covariance that the filter had there. So millimetres of drift on a street and metres on a field have one cause and one
/// figure (README.md). On top comes a small walk of its own and what the first map's tilt is worth.
struct MapDriftConfig {
  double renewal_m = 20.0;               // travel in which the map around is another one
  double position_m_rtm = 3.0e-4;        // walk besides, metres per root metre
  double attitude_rad_rtm = 5.0e-6;      // radians per root metre
  double first_tilt_rad = 2.0e-4;        // roll and pitch of a map begun at one place
  double first_heading_rad = 5.0e-5;
  double first_position_m = 4.0e-3;
  // Of a pose in its map where scans hold it. Noise up to this returns to the map with the next scan, beyond it adds up.
  double held_position_m = 3.0e-3;
  double held_attitude_rad = 3.0e-4;
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

/// What a step of the filter adds to the drift: its covariance (any frame) less the noise that does not add up, along each
/// direction by itself; zero where scans held the pose.
Matrix6d lasting_part(const MapDriftConfig& config, const Matrix6d& step);

/// Carries the drift over a move of base from T_odom_a to T_odom_b: an error of attitude at `a` displaces `b`, and what the
/// map took in on the way adds its own.
/// local   covariance of base at `b` relative to the map (local_covariance); zero when nothing was put into the map
/// Rows as NavState::covariance.
Matrix6d carry_drift(const MapDriftConfig& config, const Matrix6d& drift, const Pose& T_odom_a, const Pose& T_odom_b,
                     const Matrix6d& local);

}  // namespace slamd
