#pragma once
// How the vehicle moves over one scan in its plane, as knots in time. Where the motion comes from is motion_prior's.

#include <vector>

#include "estimator/graph/group_se2.hpp"

namespace slamd {

/// Knots evenly spaced from begin to end; between them the pose goes evenly.
class PlanarMotion {
 public:
  /// T_odom_base at begin_s, then step_s apart, at least one; seconds from any common origin.
  void assign(double begin_s, double step_s, std::vector<PlanarPose>& poses) {
    begin_s_ = begin_s;
    step_s_ = step_s;
    poses_.swap(poses);
  }
  const PlanarPose& end() const { return poses_.back(); }
  const PlanarPose& begin() const { return poses_.front(); }
  double end_s() const { return begin_s_ + step_s_ * static_cast<double>(poses_.size() - 1); }

  /// T_end_base of an instant; before the begin that of the begin, after the end that of the end.
  PlanarPose relative_to_end(double time_s) const {
    const std::size_t last = poses_.size() - 1;
    const double at = step_s_ > 0.0 ? std::clamp((time_s - begin_s_) / step_s_, 0.0, static_cast<double>(last)) : 0.0;
    const std::size_t i = std::min(static_cast<std::size_t>(at), last == 0 ? 0 : last - 1);
    const PlanarPose T_end_knot = poses_.back().inverse() * poses_[i];
    if (last == 0) return T_end_knot;
    const GroupSe2::Tangent step = GroupSe2::minus(poses_[i + 1], poses_[i]);
    return GroupSe2::plus(T_end_knot, (at - static_cast<double>(i)) * step);
  }
  /// The end moves by this, the begin stays, what is between takes its share in proportion to time.
  void bend(const PlanarPose& corrected_end) {
    const GroupSe2::Tangent e = GroupSe2::minus(corrected_end, poses_.back());
    const double last = static_cast<double>(poses_.size() - 1);
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      poses_[i] = GroupSe2::plus(poses_[i], (last > 0.0 ? static_cast<double>(i) / last : 1.0) * e);
    }
  }

 private:
  double begin_s_ = 0.0, step_s_ = 0.0;
  std::vector<PlanarPose> poses_;
};

}  // namespace slamd
