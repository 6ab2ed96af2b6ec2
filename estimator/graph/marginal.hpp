#pragma once
// Covariance of one variable of a solved problem. One variable at a time: a whole inverse is never formed.

#include <ceres/problem.h>

#include <Eigen/Core>

namespace slamd {

/// The marginal covariance of `block` (in its tangent space) at the problem's present values, robust weights included.
/// Empty when the problem does not constrain it. Cost: about one iteration of a solve.
Eigen::MatrixXd marginal_covariance(ceres::Problem& problem, double* block);

}  // namespace slamd
