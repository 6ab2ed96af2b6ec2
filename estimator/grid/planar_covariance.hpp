#pragma once
// Covariances of planar poses from one place to another. Groups and graphs are estimator/graph's.

#include "estimator/graph/group_se2.hpp"

namespace slamd {

/// Ad with T_a_b * Exp(e) = Exp(Ad e) * T_a_b to first order; rows x, y (m), yaw (rad).
inline Eigen::Matrix3d planar_adjoint(const PlanarPose& T_a_b) {
  Eigen::Matrix3d ad = Eigen::Matrix3d::Identity();
  ad.topLeftCorner<2, 2>() = T_a_b.rotation();
  ad(0, 2) = T_a_b.translation.y();
  ad(1, 2) = -T_a_b.translation.x();
  return ad;
}

}  // namespace slamd
