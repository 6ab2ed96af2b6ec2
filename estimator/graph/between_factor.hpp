#pragma once
// Factors of measured poses: between two poses, and a prior on one. Whitened; robust losses are the caller's.

#include <ceres/sized_cost_function.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "estimator/graph/rotation_error.hpp"

namespace slamd {

/// W with W^T W = information; symmetric, positive semidefinite: directions of which nothing is known weigh nothing.
template <class Matrix>
Matrix square_root(const Matrix& information) {
  const Eigen::LLT<Matrix> llt{information};
  if (llt.info() == Eigen::Success) return llt.matrixU();
  const Eigen::SelfAdjointEigenSolver<Matrix> axes{information};
  return axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * axes.eigenvectors().transpose();
}

/// Writes W * J to a solver's row-major block, the columns beyond the perturbation's zero (see manifold.hpp).
template <int kSize, class Whitened>
void write_jacobian(const Whitened& J, double* block) {
  Eigen::Map<Eigen::Matrix<double, Whitened::RowsAtCompileTime, kSize, Eigen::RowMajor>> out{block};
  out.template leftCols<Whitened::ColsAtCompileTime>() = J;
  out.template rightCols<kSize - Whitened::ColsAtCompileTime>().setZero();
}

/// r = W * e with T_map_a^-1 T_map_b = measured_a_b * Exp(e).
template <class Group>
class BetweenFactor final : public ceres::SizedCostFunction<Group::kDof, Group::kSize, Group::kSize> {
 public:
  using Matrix = typename Group::Matrix;

  /// whitening  W with W^T W = information of e
  BetweenFactor(const typename Group::Element& measured_a_b, const Matrix& whitening, RotationError kind)
      : measured_{measured_a_b}, whitening_{whitening}, kind_{kind} {}

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override {
    Matrix J_e_a, J_e_b;
    double* const a = jacobians != nullptr ? jacobians[0] : nullptr;
    double* const b = jacobians != nullptr ? jacobians[1] : nullptr;
    const typename Group::Tangent e =
        Group::between_error(Group::load(blocks[0]), Group::load(blocks[1]), measured_, kind_,
                             a != nullptr ? &J_e_a : nullptr, b != nullptr ? &J_e_b : nullptr);
    Eigen::Map<typename Group::Tangent>{residual}.noalias() = whitening_ * e;
    if (a != nullptr) write_jacobian<Group::kSize>(Matrix{whitening_ * J_e_a}, a);
    if (b != nullptr) write_jacobian<Group::kSize>(Matrix{whitening_ * J_e_b}, b);
    return true;
  }

 private:
  typename Group::Element measured_;
  Matrix whitening_;
  RotationError kind_;
};

/// r = W * e with T_map_a = measured * Exp(e).
template <class Group>
class PriorFactor final : public ceres::SizedCostFunction<Group::kDof, Group::kSize> {
 public:
  using Matrix = typename Group::Matrix;

  PriorFactor(const typename Group::Element& measured, const Matrix& whitening)
      : measured_{measured}, whitening_{whitening} {}

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override {
    Matrix J;
    double* const out = jacobians != nullptr ? jacobians[0] : nullptr;
    const typename Group::Tangent e = Group::between_error(typename Group::Element{}, Group::load(blocks[0]), measured_,
                                                           RotationError::kLog, nullptr, out != nullptr ? &J : nullptr);
    Eigen::Map<typename Group::Tangent>{residual}.noalias() = whitening_ * e;
    if (out != nullptr) write_jacobian<Group::kSize>(Matrix{whitening_ * J}, out);
    return true;
  }

 private:
  typename Group::Element measured_;
  Matrix whitening_;
};

}  // namespace slamd
