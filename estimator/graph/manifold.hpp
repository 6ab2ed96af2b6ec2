#pragma once
// The solver's manifold of a group. Factors give Jacobians by the perturbation itself in their first kDof columns (the
// rest zero), which PlusJacobian = [I; 0] hands through: no derivative of a quaternion's four numbers is ever formed.

#include <ceres/manifold.h>

#include <Eigen/Core>

namespace slamd {

template <class Group>
class GroupManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return Group::kSize; }
  int TangentSize() const override { return Group::kDof; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    Group::store(Group::plus(Group::load(x), Eigen::Map<const typename Group::Tangent>{delta}), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, Group::kSize, Group::kDof, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<typename Group::Tangent>{y_minus_x} = Group::minus(Group::load(y), Group::load(x));
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, Group::kDof, Group::kSize, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
};

}  // namespace slamd
