#include "estimator/graph/odometry_chain.hpp"

#include "estimator/math/se3.hpp"

namespace slamd {

void OdometryChain::add(const Pose& T_odom_base, const Matrix6d& relative_covariance) {
  poses_.push_back(T_odom_base);
  if (sums_.empty()) {
    sums_.push_back(Matrix6d::Zero());
    return;
  }
  // A step's error in the base of keyframe 0: Exp(Ad(T_0_i) e) T_0_i = T_0_i Exp(e).
  const Matrix6d Ad_0_i = adjoint(relative(0, poses_.size() - 1));
  sums_.push_back(sums_.back() + Ad_0_i * relative_covariance * Ad_0_i.transpose());
}

Matrix6d OdometryChain::relative_covariance(std::size_t a, std::size_t b) const {
  const Matrix6d steps = b > a ? sums_[b] - sums_[a] : sums_[a] - sums_[b];
  const Matrix6d Ad_b_0 = adjoint(relative(b, 0));
  return Ad_b_0 * steps * Ad_b_0.transpose();
}

}  // namespace slamd
