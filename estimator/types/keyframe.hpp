#pragma once
// What the front end hands to the mapping thread every few metres. Not corrected: the back end owns corrections.

#include <cstdint>

#include "estimator/types/nav_state.hpp"
#include "estimator/types/point_cloud.hpp"

namespace slamd {

struct Keyframe {
  std::uint64_t id = 0;  // counts from 0 without gaps
  NavState state;        // at the scan's end
  /// Of T_previous_this, the pose of this base in the previous keyframe's base, as the front end measured it, cross terms
  /// of the two poses included and without the noise that returns to the map instead of adding up over keyframes:
  /// T_true = T_previous_this * Exp(e). Rows 0-2 translation (m), rows 3-5 rotation (rad), both
  /// in this keyframe's base. Zero at the first keyframe.
  Matrix6d relative_covariance = Matrix6d::Zero();
  Eigen::Vector3d up_base = Eigen::Vector3d::UnitZ();  // unit, against gravity, in this base
  double up_sigma_rad = 1.0;                           // of up_base, an axis
  PointCloud points;     // in order of firing, de-skewed to state.time, base frame
  Duration scan_span{};  // first firing to state.time
};

}  // namespace slamd
