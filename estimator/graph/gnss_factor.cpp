#include "estimator/graph/gnss_factor.hpp"

#include "estimator/graph/between_factor.hpp"

namespace slamd {

void EnuBlock::store(const EnuAlignment& enu, double* block) {
  Eigen::Map<Eigen::Vector3d>{block} = enu.translation;
  block[3] = enu.yaw_rad;
}

EnuAlignment EnuBlock::load(const double* block) {
  EnuAlignment enu;
  enu.translation = Eigen::Map<const Eigen::Vector3d>{block};
  enu.yaw_rad = block[3];
  return enu;
}

bool GnssFactor::Evaluate(double const* const* blocks, double* residual, double** jacobians) const {
  const Pose T_map_base = GroupSe3::load(blocks[0]);
  const Pose T_enu_map = EnuBlock::load(blocks[1]).T_enu_map();
  const Eigen::Vector3d p_enu = T_enu_map * (T_map_base * p_base_antenna_);
  Eigen::Map<Eigen::Vector3d>{residual} = inverse_sigma_.cwiseProduct(p_enu - p_enu_);
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    const Eigen::Matrix3d R_enu_base = (T_enu_map.rotation * T_map_base.rotation).toRotationMatrix();
    Eigen::Matrix<double, 3, GroupSe3::kDof> J;
    J << R_enu_base, -R_enu_base * skew(p_base_antenna_);
    write_jacobian<GroupSe3::kSize>((inverse_sigma_.asDiagonal() * J).eval(), jacobians[0]);
  }
  if (jacobians[1] != nullptr) {
    const Eigen::Vector3d arm = p_enu - T_enu_map.translation;  // turned by yaw
    Eigen::Matrix<double, 3, EnuBlock::kSize> J;
    J << Eigen::Matrix3d::Identity(), Eigen::Vector3d{-arm.y(), arm.x(), 0.0};
    write_jacobian<EnuBlock::kSize>((inverse_sigma_.asDiagonal() * J).eval(), jacobians[1]);
  }
  return true;
}

}  // namespace slamd
