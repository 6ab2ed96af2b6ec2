#include "estimator/graph/group_se2.hpp"

namespace slamd {

GroupSe2::Tangent GroupSe2::between_error(const Element& T_map_a, const Element& T_map_b, const Element& measured_a_b,
                                          RotationError kind, Matrix* J_e_a, Matrix* J_e_b) {
  const Eigen::Matrix2d R_m_a = measured_a_b.rotation().transpose();
  const Eigen::Vector2d t_a_b = T_map_a.rotation().transpose() * (T_map_b.translation - T_map_a.translation);
  const double angle = wrap_angle(T_map_b.yaw_rad - T_map_a.yaw_rad - measured_a_b.yaw_rad);
  const bool chordal = kind == RotationError::kChordal;
  const double slope = chordal ? std::cos(0.5 * angle) : 1.0;
  Tangent e;
  e.head<2>() = R_m_a * (t_a_b - measured_a_b.translation);
  e[2] = chordal ? 2.0 * std::sin(0.5 * angle) : angle;
  if (J_e_a != nullptr) {
    J_e_a->setZero();
    J_e_a->topLeftCorner<2, 2>() = -R_m_a;
    J_e_a->topRightCorner<2, 1>() = R_m_a * Eigen::Vector2d{t_a_b.y(), -t_a_b.x()};
    (*J_e_a)(2, 2) = -slope;
  }
  if (J_e_b != nullptr) {
    J_e_b->setZero();
    J_e_b->topLeftCorner<2, 2>() = Eigen::Rotation2Dd{angle}.toRotationMatrix();
    (*J_e_b)(2, 2) = slope;
  }
  return e;
}

}  // namespace slamd
