#pragma once
// Levels a pose by the direction of gravity that the filter measured. Says nothing of yaw and position.

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>

#include "estimator/graph/group_se3.hpp"

namespace slamd {

/// r = (R_map_base * up_base) x,y / sigma: map's z axis is up. Two rows, exact for small tilts and wrong for none below 90
/// degrees.
class GravityFactor final : public ceres::SizedCostFunction<2, GroupSe3::kSize> {
 public:
  /// up_base  unit, against gravity; sigma_rad > 0, an axis
  GravityFactor(const Eigen::Vector3d& up_base, double sigma_rad) : up_base_{up_base}, inverse_sigma_{1.0 / sigma_rad} {}

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override;

 private:
  Eigen::Vector3d up_base_;
  double inverse_sigma_;
};

}  // namespace slamd
