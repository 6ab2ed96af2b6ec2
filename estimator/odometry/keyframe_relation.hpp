#pragma once
// What a keyframe's pose is worth relative to the keyframe before: the filter's own part and the map's walk in between.
// Decides neither when a keyframe is due nor what is in it.

#include "estimator/filter/inertial_state.hpp"
#include "estimator/odometry/map_drift.hpp"

namespace slamd {

/// A direction of the vehicle and how well it is known.
struct UpDirection {
  Eigen::Vector3d up_base = Eigen::Vector3d::UnitZ();  // unit, against gravity
  double sigma_rad = 1.0;                              // an axis
};

class KeyframeRelation {
 public:
  KeyframeRelation(const MapDriftConfig& config, const Pose& T_base_imu) : config_{config}, T_base_imu_{T_base_imu} {}

  /// The scan moved base from T_odom_a to T_odom_b, where it is known to `local` (carry_drift). Once a scan.
  void carry(const Pose& T_odom_a, const Pose& T_odom_b, const Matrix6d& local);
  /// The local map is about to begin anew at the filter's pose, which from then on has no error of its own: what it was
  /// worth so far is kept here.
  void keep_before_new_map(FilterSnapshot& filter);
  /// Nothing joins what comes to what was: odom itself began anew.
  void break_off();
  /// Of a keyframe at the filter's pose: Keyframe::relative_covariance. Zero the first time. The next relation begins here.
  Matrix6d take(FilterSnapshot& filter);

 private:
  Matrix6d covariance(const FilterSnapshot& filter) const;

  MapDriftConfig config_;
  Pose T_base_imu_;
  Matrix6d walk_ = Matrix6d::Zero();  // since the keyframe; rows as NavState::covariance
  bool has_keyframe_ = false;
};

/// Against gravity in base, by the filter's attitude and gravity.
UpDirection up_direction(const FilterSnapshot& filter, const Pose& T_base_imu);

}  // namespace slamd
