#pragma once
// The rotation nearest to a matrix. Nothing else of linear algebra lives here.

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace slamd {

/// Minimises ||R - M||_F over rotations (orthogonal Procrustes); for a singular M one of the nearest.
template <int N>
Eigen::Matrix<double, N, N> nearest_rotation(const Eigen::Matrix<double, N, N>& M) {
  const Eigen::JacobiSVD<Eigen::Matrix<double, N, N>> svd{M, Eigen::ComputeFullU | Eigen::ComputeFullV};
  Eigen::Matrix<double, N, 1> signs = Eigen::Matrix<double, N, 1>::Ones();
  signs[N - 1] = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace slamd
