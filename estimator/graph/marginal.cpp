#include "estimator/graph/marginal.hpp"

#include <ceres/crs_matrix.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <vector>

namespace slamd {

Eigen::MatrixXd marginal_covariance(ceres::Problem& problem, double* block) {
  ceres::Problem::EvaluateOptions options;
  problem.GetParameterBlocks(&options.parameter_blocks);
  std::erase_if(options.parameter_blocks, [&problem](const double* b) { return problem.IsParameterBlockConstant(b); });
  // The wanted one last: its columns are then the last ones.
  std::stable_partition(options.parameter_blocks.begin(), options.parameter_blocks.end(),
                        [block](const double* other) { return other != block; });
  ceres::CRSMatrix crs;
  if (!problem.Evaluate(options, nullptr, nullptr, nullptr, &crs)) return {};
  using RowMajor = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  const Eigen::Map<const RowMajor> J{crs.num_rows,     crs.num_cols,    static_cast<int>(crs.values.size()),
                                     crs.rows.data(), crs.cols.data(), crs.values.data()};
  const Eigen::SparseMatrix<double> H = J.transpose() * J;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factorisation{H};
  const bool definite = factorisation.info() == Eigen::Success && factorisation.vectorD().minCoeff() > 0.0;
  if (!definite) return {};
  const int size = problem.ParameterBlockTangentSize(block);
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(H.rows(), size);
  unit.bottomRows(size).setIdentity();
  return factorisation.solve(unit).bottomRows(size);
}

}  // namespace slamd
