#include "estimator/graph/correction.hpp"

#include <algorithm>

#include "estimator/math/se3.hpp"

namespace slamd {
namespace {

/// Where a keyframe's own correction puts the pose.
Pose moved_by(const KeyframeEstimate& keyframe, const Pose& T_odom_base) {
  return keyframe.T_map_base * (keyframe.T_odom_base.inverse() * T_odom_base);
}

}  // namespace

Pose corrected_pose(const GraphSolution& solution, HostTime time, const Pose& T_odom_base) {
  const auto& keyframes = solution.keyframes;
  const auto after = std::upper_bound(keyframes.begin(), keyframes.end(), time,
                                      [](HostTime t, const KeyframeEstimate& keyframe) { return t < keyframe.time; });
  if (keyframes.empty()) return solution.T_map_odom * T_odom_base;
  if (after == keyframes.begin()) return moved_by(*after, T_odom_base);
  const auto before = std::prev(after);
  if (after == keyframes.end()) return moved_by(*before, T_odom_base);
  const double share = to_seconds(time - before->time) / to_seconds(after->time - before->time);
  return interpolate(moved_by(*before, T_odom_base), moved_by(*after, T_odom_base), share);
}

}  // namespace slamd
