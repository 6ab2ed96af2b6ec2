#pragma once
// The covariance of a measured edge from its information. Of solved poses it is marginal.hpp.

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace slamd {

/// Large instead of infinite where nothing is known of a direction. information: symmetric, positive semidefinite, not zero.
template <class Matrix>
Matrix covariance_of(const Matrix& information) {
  constexpr double kNextToNothing = 1e-9;
  if (information.llt().info() == Eigen::Success) return information.inverse();
  return (information + kNextToNothing * information.diagonal().maxCoeff() * Matrix::Identity()).inverse();
}

}  // namespace slamd
