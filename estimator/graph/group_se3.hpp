#pragma once
// SE(3) as the solver's variable: layout, perturbation and the error between two poses with analytic Jacobians. Its twin
// is group_se2.hpp; templates over `Group` serve both.

#include <Eigen/Core>

#include "estimator/graph/rotation_error.hpp"
#include "estimator/math/se3.hpp"

namespace slamd {

struct GroupSe3 {
  static constexpr int kDof = 6;        // rows of errors and Jacobians: translation, rotation
  static constexpr int kSize = 7;       // stored: translation, quaternion x y z w
  static constexpr int kDimension = 3;  // of the space
  using Element = Pose;
  using Tangent = Eigen::Matrix<double, kDof, 1>;
  using Matrix = Eigen::Matrix<double, kDof, kDof>;

  static Element load(const double* block) {
    return {Eigen::Map<const Eigen::Quaterniond>{block + 3}, Eigen::Map<const Eigen::Vector3d>{block}};
  }
  static void store(const Element& T, double* block) {
    Eigen::Map<Eigen::Vector3d>{block} = T.translation;
    Eigen::Map<Eigen::Vector4d>{block + 3} = T.rotation.coeffs();
  }
  static Element plus(const Element& T, const Tangent& d) { return boxplus(T, d); }
  static Tangent minus(const Element& to, const Element& from) { return boxminus(to, from); }
  static Eigen::Matrix3d rotation(const Element& T) { return T.rotation.toRotationMatrix(); }
  static Eigen::Vector3d translation(const Element& T) { return T.translation; }
  /// R need not be a rotation: the nearest one is taken (Frobenius norm).
  static Element make(const Eigen::Matrix3d& R, const Eigen::Vector3d& t);

  /// e = minus(T_a^-1 T_b, measured), its rotation by `kind`; J_e_a and J_e_b (may be null) by plus() of each pose.
  /// Checked against finite differences in tests/estimator/between_factor_test.cpp.
  static Tangent between_error(const Element& T_map_a, const Element& T_map_b, const Element& measured_a_b,
                               RotationError kind, Matrix* J_e_a, Matrix* J_e_b);
};

}  // namespace slamd
