#pragma once
// SE(3) as far as graphs need it: adjoint, and errors of poses as (translation, rotation) with their Jacobians. The pose
// itself is estimator/types/pose.hpp; SO(3) is lie.hpp.

#include "estimator/math/lie.hpp"
#include "estimator/types/pose.hpp"

namespace slamd {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Ad(T_a_b): T_a_b * Exp(e) = Exp(Ad(T_a_b) e) * T_a_b to first order, rows translation, then rotation.
/// Source: Sola et al. 2018, eq. (175).
inline Matrix6d adjoint(const Pose& T_a_b) {
  const Eigen::Matrix3d R = T_a_b.rotation.toRotationMatrix();
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = R;
  ad.topRightCorner<3, 3>() = skew(T_a_b.translation) * R;
  ad.bottomRightCorner<3, 3>() = R;
  return ad;
}

/// T * Exp(e) with translation and rotation moved apart: (t + R e_t, R Exp(e_r)).
inline Pose boxplus(const Pose& T, const Vector6d& e) {
  return {(T.rotation * exp_so3(e.tail<3>())).normalized(), T.translation + T.rotation * e.head<3>()};
}

/// e with boxplus(from, e) = to.
inline Vector6d boxminus(const Pose& to, const Pose& from) {
  const Pose T_from_to = from.inverse() * to;
  Vector6d e;
  e << T_from_to.translation, log_so3(T_from_to.rotation);
  return e;
}

/// From T_a at 0 to T_b at 1 (shorter way round), evenly; outside 0..1 it goes on.
inline Pose interpolate(const Pose& T_a, const Pose& T_b, double share) {
  return boxplus(T_a, share * boxminus(T_b, T_a));
}

}  // namespace slamd
