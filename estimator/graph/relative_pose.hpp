#pragma once
// A measured pose with the covariance of its error, and the composition of such poses. No graph, no optimisation.

#include "estimator/math/se3.hpp"
#include "estimator/types/pose.hpp"

namespace slamd {

/// T_true = T_a_b * Exp(e), rows of the covariance translation (m), then rotation (rad), in b.
struct RelativePose {
  Pose T_a_b;
  Matrix6d covariance = Matrix6d::Zero();

  RelativePose inverse() const {
    const Matrix6d Ad_a_b = adjoint(T_a_b);
    return {T_a_b.inverse(), Ad_a_b * covariance * Ad_a_b.transpose()};
  }
  /// Errors of the two are independent; covariance to first order.
  RelativePose operator*(const RelativePose& T_b_c) const {
    const Matrix6d Ad_c_b = adjoint(T_b_c.T_a_b.inverse());
    return {T_a_b * T_b_c.T_a_b, Ad_c_b * covariance * Ad_c_b.transpose() + T_b_c.covariance};
  }
};

}  // namespace slamd
