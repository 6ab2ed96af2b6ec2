#include "estimator/filter/pose_clone.hpp"

namespace slamd {

using I = ErrorIndex;

void take_clone(FilterSnapshot& filter) {
  filter.clone.T_odom_imu = filter.state.T_odom_imu();
  filter.clone.covariance = filter.covariance.topLeftCorner<6, 6>();
  filter.clone.cross = filter.covariance.leftCols<6>();
}

Matrix6d motion_covariance(const FilterSnapshot& filter) {
  const Pose T_clone_imu = filter.clone.T_odom_imu.inverse() * filter.state.T_odom_imu();
  const Eigen::Matrix3d R_imu_odom = filter.state.R_odom_imu.conjugate().toRotationMatrix();
  const Eigen::Matrix3d R_imu_clone = T_clone_imu.rotation.conjugate().toRotationMatrix();
  Matrix6d J_imu = Matrix6d::Zero();
  J_imu.block<3, 3>(0, I::kPosition) = R_imu_odom;
  J_imu.block<3, 3>(3, I::kAttitude) = Eigen::Matrix3d::Identity();
  Matrix6d J_clone = Matrix6d::Zero();
  J_clone.block<3, 3>(0, I::kPosition) = -R_imu_odom;
  J_clone.block<3, 3>(0, I::kAttitude) = R_imu_clone * skew(T_clone_imu.translation);
  J_clone.block<3, 3>(3, I::kAttitude) = -R_imu_clone;

  const Matrix6d shared = J_imu * filter.clone.cross.topRows<6>() * J_clone.transpose();
  return J_imu * filter.covariance.topLeftCorner<6, 6>() * J_imu.transpose() +
         J_clone * filter.clone.covariance * J_clone.transpose() + shared + shared.transpose();
}

}  // namespace slamd
