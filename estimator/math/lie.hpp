#pragma once
// SO(3) and S2 with their Jacobians, header-only. Not SE(3) as one group: poses are kept as rotation and translation.
// Source: Sola, Deray, Atchuthan, "A micro Lie theory" (2018), equation numbers below.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace slamd {

using Matrix32d = Eigen::Matrix<double, 3, 2>;

/// [v]x, so that skew(v) * w = v x w.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Rotation vector (rad) to unit quaternion, eq. (132) in quaternion form; exact to rounding at any angle.
inline Eigen::Quaterniond exp_so3(const Eigen::Vector3d& theta) {
  const double angle2 = theta.squaredNorm();
  double sin_half_over_angle = 0.5 - angle2 / 48.0;
  double cos_half = 1.0 - angle2 / 8.0;
  if (angle2 > 1e-8) {
    const double angle = std::sqrt(angle2);
    sin_half_over_angle = std::sin(0.5 * angle) / angle;
    cos_half = std::cos(0.5 * angle);
  }
  const Eigen::Vector3d v = sin_half_over_angle * theta;
  return Eigen::Quaterniond{cos_half, v.x(), v.y(), v.z()}.normalized();
}

/// Inverse of exp_so3, angle in [0, pi], eq. (133).
inline Eigen::Vector3d log_so3(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * q.vec();
  const double sin_half = v.norm();
  const double cos_half = sign * q.w();
  if (sin_half < 1e-7) return (2.0 / cos_half) * v;
  return (2.0 * std::atan2(sin_half, cos_half) / sin_half) * v;
}

/// J_r with Exp(theta + d) = Exp(theta) Exp(J_r d), eq. (143).
inline Eigen::Matrix3d right_jacobian_so3(const Eigen::Vector3d& theta) {
  const double angle2 = theta.squaredNorm();
  const Eigen::Matrix3d k = skew(theta);
  if (angle2 < 1e-8) return Eigen::Matrix3d::Identity() - 0.5 * k + k * k / 6.0;
  const double angle = std::sqrt(angle2);
  return Eigen::Matrix3d::Identity() - (1.0 - std::cos(angle)) / angle2 * k +
         (angle - std::sin(angle)) / (angle2 * angle) * k * k;
}

/// J_r^-1, eq. (144), with (1 + cos a) / sin a written as cot(a / 2), which keeps its digits at pi.
inline Eigen::Matrix3d right_jacobian_inverse_so3(const Eigen::Vector3d& theta) {
  const double angle2 = theta.squaredNorm();
  const Eigen::Matrix3d k = skew(theta);
  if (angle2 < 1e-8) return Eigen::Matrix3d::Identity() + 0.5 * k + k * k / 12.0;
  const double angle = std::sqrt(angle2);
  const double c = 1.0 / angle2 - std::cos(0.5 * angle) / (2.0 * angle * std::sin(0.5 * angle));
  return Eigen::Matrix3d::Identity() + 0.5 * k + c * k * k;
}

/// Two unit vectors orthogonal to v and to each other, as columns; continuous but where |v.x| passes 0.9 |v|. v need not
/// be unit.
inline Matrix32d tangent_basis_s2(const Eigen::Vector3d& v) {
  const Eigen::Vector3d n = v.normalized();
  const Eigen::Vector3d helper = std::abs(n.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  Matrix32d basis;
  basis.col(0) = n.cross(helper).normalized();
  basis.col(1) = n.cross(basis.col(0));
  return basis;
}

/// v turned by the tangent vector d (rad, in the basis of v); keeps |v|. Source: Xu et al. 2022, eq. (3)-(4).
inline Eigen::Vector3d boxplus_s2(const Eigen::Vector3d& v, const Eigen::Vector2d& d) {
  return exp_so3(tangent_basis_s2(v) * d) * v;
}

/// d with boxplus_s2(from, d) = to, for |from| = |to| not opposite.
inline Eigen::Vector2d boxminus_s2(const Eigen::Vector3d& to, const Eigen::Vector3d& from) {
  const Eigen::Vector3d axis = from.cross(to);
  const double sine = axis.norm();
  if (sine < 1e-15) return Eigen::Vector2d::Zero();
  const double angle = std::atan2(sine, from.dot(to));
  return tangent_basis_s2(from).transpose() * (axis * (angle / sine));
}

/// Replaces m by the nearest symmetric matrix: rounding must not grow in a covariance.
template <class Matrix>
void symmetrise(Matrix& m) { m = (0.5 * (m + m.transpose())).eval(); }

}  // namespace slamd
