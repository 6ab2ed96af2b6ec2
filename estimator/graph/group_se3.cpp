#include "estimator/graph/group_se3.hpp"

#include "estimator/graph/nearest_rotation.hpp"

namespace slamd {

GroupSe3::Element GroupSe3::make(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  return {Eigen::Quaterniond{nearest_rotation<3>(R)}.normalized(), t};
}

namespace {

/// The error of a rotation and its derivative by a perturbation on its right.
Eigen::Vector3d rotation_error(const Eigen::Quaterniond& R, RotationError kind, Eigen::Matrix3d& J) {
  if (kind == RotationError::kLog) {
    const Eigen::Vector3d e = log_so3(R);
    J = right_jacobian_inverse_so3(e);
    return e;
  }
  const double sign = R.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * R.vec();
  J = sign * R.w() * Eigen::Matrix3d::Identity() + skew(v);
  return 2.0 * v;
}

}  // namespace

GroupSe3::Tangent GroupSe3::between_error(const Element& T_map_a, const Element& T_map_b, const Element& measured_a_b,
                                          RotationError kind, Matrix* J_e_a, Matrix* J_e_b) {
  const Eigen::Quaterniond R_a_map = T_map_a.rotation.conjugate();
  const Eigen::Quaterniond R_m_a = measured_a_b.rotation.conjugate();
  const Eigen::Vector3d t_a_b = R_a_map * (T_map_b.translation - T_map_a.translation);
  const Eigen::Quaterniond R_a_b = R_a_map * T_map_b.rotation;
  const Eigen::Quaterniond R_m_b = R_m_a * R_a_b;  // identity when the poses are as measured
  Eigen::Matrix3d J_rotation;
  Tangent e;
  e.head<3>() = R_m_a * (t_a_b - measured_a_b.translation);
  e.tail<3>() = rotation_error(R_m_b, kind, J_rotation);
  if (J_e_a != nullptr) {
    const Eigen::Matrix3d R = R_m_a.toRotationMatrix();
    J_e_a->topLeftCorner<3, 3>() = -R;
    J_e_a->topRightCorner<3, 3>() = R * skew(t_a_b);
    J_e_a->bottomLeftCorner<3, 3>().setZero();
    J_e_a->bottomRightCorner<3, 3>() = -J_rotation * R_a_b.toRotationMatrix().transpose();
  }
  if (J_e_b != nullptr) {
    J_e_b->setZero();
    J_e_b->topLeftCorner<3, 3>() = R_m_b.toRotationMatrix();
    J_e_b->bottomRightCorner<3, 3>() = J_rotation;
  }
  return e;
}

}  // namespace slamd
