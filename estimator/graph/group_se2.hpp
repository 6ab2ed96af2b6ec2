#pragma once
// SE(2) as the solver's variable: layout, perturbation and the error between two poses with analytic Jacobians. The twin
// of group_se3.hpp, for planar graphs.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "estimator/graph/nearest_rotation.hpp"
#include "estimator/graph/rotation_error.hpp"

namespace slamd {

/// T_a_b in the plane: p_a = R(yaw) * p_b + translation.
struct PlanarPose {
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();  // metres
  double yaw_rad = 0.0;                                   // any multiple of 2 pi more means the same

  Eigen::Matrix2d rotation() const { return Eigen::Rotation2Dd{yaw_rad}.toRotationMatrix(); }
  PlanarPose operator*(const PlanarPose& T_b_c) const {
    return {translation + rotation() * T_b_c.translation, yaw_rad + T_b_c.yaw_rad};
  }
  PlanarPose inverse() const { return {-(rotation().transpose() * translation), -yaw_rad}; }
};

/// The same angle in [-pi, pi].
inline double wrap_angle(double rad) { return std::remainder(rad, 2.0 * M_PI); }

struct GroupSe2 {
  static constexpr int kDof = 3;        // rows of errors and Jacobians: translation, yaw
  static constexpr int kSize = 3;       // stored: translation, yaw
  static constexpr int kDimension = 2;  // of the space
  using Element = PlanarPose;
  using Tangent = Eigen::Matrix<double, kDof, 1>;
  using Matrix = Eigen::Matrix<double, kDof, kDof>;

  static Element load(const double* block) { return {Eigen::Map<const Eigen::Vector2d>{block}, block[2]}; }
  static void store(const Element& T, double* block) {
    Eigen::Map<Eigen::Vector2d>{block} = T.translation;
    block[2] = T.yaw_rad;
  }
  static Element plus(const Element& T, const Tangent& d) {
    return {T.translation + T.rotation() * d.head<2>(), T.yaw_rad + d[2]};
  }
  static Tangent minus(const Element& to, const Element& from) {
    const Element T_from_to = from.inverse() * to;
    return {T_from_to.translation.x(), T_from_to.translation.y(), wrap_angle(T_from_to.yaw_rad)};
  }
  static Eigen::Matrix2d rotation(const Element& T) { return T.rotation(); }
  static Eigen::Vector2d translation(const Element& T) { return T.translation; }
  /// R need not be a rotation: the nearest one is taken (Frobenius norm).
  static Element make(const Eigen::Matrix2d& R, const Eigen::Vector2d& t) {
    const Eigen::Matrix2d nearest = nearest_rotation<2>(R);
    return {t, std::atan2(nearest(1, 0), nearest(0, 0))};
  }

  /// As GroupSe3::between_error.
  static Tangent between_error(const Element& T_map_a, const Element& T_map_b, const Element& measured_a_b,
                               RotationError kind, Matrix* J_e_a, Matrix* J_e_b);
};

}  // namespace slamd
