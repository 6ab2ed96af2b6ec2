#pragma once
// A solver's factor against central differences over its own perturbations. Tests of estimator/graph share it.

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "estimator/graph/group_se3.hpp"

namespace slamd::test {

/// One variable: its stored numbers, the size of its perturbation, and how that moves it.
struct Variable {
  std::vector<double> values;
  int tangent = 0;
  std::function<std::vector<double>(const std::vector<double>&, const Eigen::VectorXd&)> plus;
};

template <class Group>
Variable variable(const typename Group::Element& element) {
  Variable v{std::vector<double>(Group::kSize), Group::kDof, {}};
  Group::store(element, v.values.data());
  v.plus = [](const std::vector<double>& values, const Eigen::VectorXd& d) {
    std::vector<double> moved(Group::kSize);
    Group::store(Group::plus(Group::load(values.data()), typename Group::Tangent{d}), moved.data());
    return moved;
  };
  return v;
}

/// Numbers that are simply added.
inline Variable additive(const std::vector<double>& values) {
  return {values, static_cast<int>(values.size()), [](std::vector<double> moved, const Eigen::VectorXd& d) {
            for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += d[static_cast<Eigen::Index>(i)];
            return moved;
          }};
}

inline Eigen::VectorXd residual_of(const ceres::CostFunction& factor, const std::vector<Variable>& variables) {
  std::vector<const double*> blocks;
  for (const Variable& v : variables) blocks.push_back(v.values.data());
  Eigen::VectorXd r{factor.num_residuals()};
  EXPECT_TRUE(factor.Evaluate(blocks.data(), r.data(), nullptr));
  return r;
}

/// Every analytic Jacobian equals central differences within `tolerance` (relative to its largest entry), and the columns
/// beyond the perturbation are zero.
inline void expect_jacobians(const ceres::CostFunction& factor, const std::vector<Variable>& variables,
                             double tolerance = 1e-6) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<const double*> blocks;
  std::vector<RowMajor> analytic;
  std::vector<double*> out;
  for (const Variable& v : variables) {
    blocks.push_back(v.values.data());
    analytic.emplace_back(factor.num_residuals(), v.values.size());
  }
  for (RowMajor& J : analytic) out.push_back(J.setConstant(1e300).data());
  Eigen::VectorXd r{factor.num_residuals()};
  ASSERT_TRUE(factor.Evaluate(blocks.data(), r.data(), out.data()));
  EXPECT_TRUE(r.isApprox(residual_of(factor, variables)));
  constexpr double kStep = 1e-5;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const int tangent = variables[k].tangent;
    RowMajor numeric{factor.num_residuals(), tangent};
    for (int i = 0; i < tangent; ++i) {
      std::vector<Variable> ahead = variables;
      std::vector<Variable> behind = variables;
      const Eigen::VectorXd d = kStep * Eigen::VectorXd::Unit(tangent, i);
      ahead[k].values = variables[k].plus(variables[k].values, d);
      behind[k].values = variables[k].plus(variables[k].values, -d);
      numeric.col(i) = (residual_of(factor, ahead) - residual_of(factor, behind)) / (2.0 * kStep);
    }
    const double scale = std::max(1.0, numeric.cwiseAbs().maxCoeff());
    EXPECT_LT((analytic[k].leftCols(tangent) - numeric).cwiseAbs().maxCoeff(), tolerance * scale) << "variable " << k;
    EXPECT_TRUE(analytic[k].rightCols(analytic[k].cols() - tangent).isZero(0.0)) << "variable " << k;
  }
}

}  // namespace slamd::test
