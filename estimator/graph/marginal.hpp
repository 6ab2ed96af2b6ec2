#pragma once
// What a solved problem says of its parts: the covariance of one variable, what one error adds to the objective. A whole
// inverse is never formed.

#include <ceres/problem.h>

#include <Eigen/Core>
#include <vector>

namespace slamd {

/// The marginal covariance of `block` (in its tangent space) at the problem's present values, robust weights included.
/// Empty when the problem does not constrain it. Cost: about one iteration of a solve.
Eigen::MatrixXd marginal_covariance(ceres::Problem& problem, double* block);

enum class ErrorsAre { kSolvedWith, kLeftOut };

/// What each of `errors` costs, one at a time, linearised and without losses: by how much the objective (twice the cost) would
/// fall without it where the problem was solved with it, or rise with it where it was left out, the rest solved anew.
/// solved  the residual blocks that the present values are the solution of
/// One a residual block of `errors`, in their order; empty when there are none or the problem is singular. Where nothing else holds
/// the problem an error costs nothing. Cost: about one iteration of a solve, and one substitution a row of `errors`.
/// Source: deletion diagnostics of least squares, Cook and Weisberg 1982, section 2.2: e^T (I - H)^-1 e with the block's
/// leverage H; its counterpart e^T (I + H)^-1 e is the innovation's Mahalanobis distance.
std::vector<double> error_costs(ceres::Problem& problem, const std::vector<ceres::ResidualBlockId>& solved,
                                const std::vector<ceres::ResidualBlockId>& errors, ErrorsAre are);

}  // namespace slamd
