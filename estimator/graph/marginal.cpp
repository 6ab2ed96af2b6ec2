#include "estimator/graph/marginal.hpp"

#include <ceres/cost_function.h>
#include <ceres/crs_matrix.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>

namespace slamd {
namespace {

using Jacobian = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Factorisation = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

constexpr double kHeldByItselfAlone = 1e-9;  // what the rest knows of a direction, as a share of all

std::vector<double*> variables(const ceres::Problem& problem) {
  std::vector<double*> blocks;
  problem.GetParameterBlocks(&blocks);
  std::erase_if(blocks, [&problem](const double* b) { return problem.IsParameterBlockConstant(b); });
  return blocks;
}

/// Empty when it cannot be evaluated.
Jacobian jacobian(ceres::Problem& problem, const ceres::Problem::EvaluateOptions& options,
                  std::vector<double>* errors = nullptr) {
  ceres::CRSMatrix crs;
  if (!problem.Evaluate(options, nullptr, errors, nullptr, &crs)) return {};
  return Eigen::Map<const Jacobian>{crs.num_rows,     crs.num_cols,    static_cast<int>(crs.values.size()),
                                    crs.rows.data(), crs.cols.data(), crs.values.data()};
}

bool factorise(const Jacobian& J, Factorisation& factorisation) {
  if (J.size() == 0) return false;
  factorisation.compute(Eigen::SparseMatrix<double>{J.transpose() * J});
  return factorisation.info() == Eigen::Success && factorisation.vectorD().minCoeff() > 0.0;
}

/// e^T M^-1 e over the directions in which M is not zero.
double quadratic_of_inverse(const Eigen::MatrixXd& M, const Eigen::VectorXd& e) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes{M};
  const Eigen::VectorXd along = axes.eigenvectors().transpose() * e;
  double sum = 0.0;
  for (Eigen::Index i = 0; i < e.size(); ++i) {
    if (axes.eigenvalues()(i) > kHeldByItselfAlone) sum += along(i) * along(i) / axes.eigenvalues()(i);
  }
  return sum;
}

}  // namespace

Eigen::MatrixXd marginal_covariance(ceres::Problem& problem, double* block) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = variables(problem);
  // The wanted one last: its columns are then the last ones.
  std::stable_partition(options.parameter_blocks.begin(), options.parameter_blocks.end(),
                        [block](const double* other) { return other != block; });
  const Jacobian J = jacobian(problem, options);
  Factorisation factorisation;
  if (!factorise(J, factorisation)) return {};
  const int size = problem.ParameterBlockTangentSize(block);
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(J.cols(), size);
  unit.bottomRows(size).setIdentity();
  return factorisation.solve(unit).bottomRows(size);
}

std::vector<double> error_costs(ceres::Problem& problem, const std::vector<ceres::ResidualBlockId>& solved,
                                const std::vector<ceres::ResidualBlockId>& errors, ErrorsAre are) {
  if (errors.empty()) return {};
  ceres::Problem::EvaluateOptions options;
  options.apply_loss_function = false;
  options.parameter_blocks = variables(problem);
  options.residual_blocks = solved;
  Factorisation factorisation;
  if (!factorise(jacobian(problem, options), factorisation)) return {};
  options.residual_blocks = errors;
  std::vector<double> e;
  const Jacobian J = jacobian(problem, options, &e);
  const double sign = are == ErrorsAre::kSolvedWith ? -1.0 : 1.0;
  std::vector<double> costs;
  for (Eigen::Index row = 0; const ceres::ResidualBlockId id : errors) {
    const int size = problem.GetCostFunctionForResidualBlock(id)->num_residuals();
    const Eigen::MatrixXd J_error = J.middleRows(row, size);
    const Eigen::MatrixXd leverage = J_error * factorisation.solve(Eigen::MatrixXd{J_error.transpose()});
    costs.push_back(quadratic_of_inverse(Eigen::MatrixXd::Identity(size, size) + sign * leverage,
                                         Eigen::Map<const Eigen::VectorXd>{e.data() + row, size}));
    row += size;
  }
  return costs;
}

}  // namespace slamd
