#include "estimator/filter/odom_frame.hpp"

namespace slamd {

using I = ErrorIndex;

namespace {

/// d(error in the new frame)/d(error in the old one); R_new_old maps between them at the estimate.
ErrorCovariance change_of_frame(const InertialState& old, const Eigen::Matrix3d& R_new_old,
                                const Eigen::Vector3d& gravity_new) {
  const Eigen::Matrix3d R_old_imu = old.R_odom_imu.toRotationMatrix();
  const Eigen::Matrix<double, 2, 3> tangent_by_turn = tangent_basis_s2(gravity_new).transpose() * R_new_old;
  ErrorCovariance J = ErrorCovariance::Identity();
  J.topRows<6>().setZero();
  J.block<3, 3>(I::kVelocity, I::kVelocity) = R_new_old;
  J.block<3, 3>(I::kVelocity, I::kAttitude) = R_new_old * skew(old.v_odom_imu) * R_old_imu;
  J.block<2, 2>(I::kGravity, I::kGravity) = tangent_by_turn * tangent_basis_s2(old.gravity);
  J.block<2, 3>(I::kGravity, I::kAttitude) = -tangent_by_turn * R_old_imu;
  return J;
}

}  // namespace

void define_odom(const Pose& T_odom_imu, FilterSnapshot& filter) {
  InertialState& state = filter.state;
  const Eigen::Quaterniond R_new_old = T_odom_imu.rotation * state.R_odom_imu.conjugate();
  const Eigen::Vector3d gravity = R_new_old * state.gravity;
  const ErrorCovariance J = change_of_frame(state, R_new_old.toRotationMatrix(), gravity);
  filter.covariance = J * filter.covariance * J.transpose();
  symmetrise(filter.covariance);
  state.R_odom_imu = T_odom_imu.rotation;
  state.p_odom_imu = T_odom_imu.translation;
  state.v_odom_imu = R_new_old * state.v_odom_imu;
  state.gravity = gravity;
}

}  // namespace slamd
