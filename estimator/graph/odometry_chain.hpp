#pragma once
// The front end's keyframes as a chain: the relative pose of any two and its covariance, in constant time. Knows no loop
// and no correction: it is what closures are checked against.

#include <cstddef>
#include <vector>

#include "estimator/types/pose.hpp"

namespace slamd {

class OdometryChain {
 public:
  /// relative_covariance  of the pose in the previous keyframe's base, as Keyframe::relative_covariance; ignored at the
  ///                      first one
  void add(const Pose& T_odom_base, const Matrix6d& relative_covariance);

  std::size_t size() const { return poses_.size(); }
  const Pose& T_odom_base(std::size_t i) const { return poses_[i]; }

  /// T_a_b as odometry measured it.
  Pose relative(std::size_t a, std::size_t b) const { return poses_[a].inverse() * poses_[b]; }

  /// Of relative(a, b), steps taken as independent: T_true = T_a_b * Exp(e), rows translation, then rotation, in the base
  /// of b. Zero for a == b. Any order of a and b.
  Matrix6d relative_covariance(std::size_t a, std::size_t b) const;

 private:
  std::vector<Pose> poses_;
  std::vector<Matrix6d> sums_;  // of all steps up to i, moved to the base of keyframe 0
};

}  // namespace slamd
