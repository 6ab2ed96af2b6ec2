#include "estimator/graph/gravity_factor.hpp"

#include "estimator/graph/between_factor.hpp"

namespace slamd {

bool GravityFactor::Evaluate(double const* const* blocks, double* residual, double** jacobians) const {
  const Eigen::Matrix3d R = GroupSe3::load(blocks[0]).rotation.toRotationMatrix();
  const Eigen::Vector3d up_map = R * up_base_;
  Eigen::Map<Eigen::Vector2d>{residual} = inverse_sigma_ * up_map.head<2>();
  if (jacobians == nullptr || jacobians[0] == nullptr) return true;
  // R Exp(d) u = R u - R [u]x d
  Eigen::Matrix<double, 2, GroupSe3::kDof> J = Eigen::Matrix<double, 2, GroupSe3::kDof>::Zero();
  J.rightCols<3>() = -inverse_sigma_ * (R * skew(up_base_)).topRows<2>();
  write_jacobian<GroupSe3::kSize>(J, jacobians[0]);
  return true;
}

}  // namespace slamd
