#include "estimator/odometry/keyframe_relation.hpp"

#include "estimator/filter/pose_clone.hpp"
#include "estimator/math/se3.hpp"

namespace slamd {

using I = ErrorIndex;

namespace {

constexpr double kUnrelated = 1e6;  // m^2 and rad^2: no relation at all

/// Position error in odom to position error in base; the attitude error is in base already.
Matrix6d odom_to_base(const FilterSnapshot& filter, const Pose& T_base_imu) {
  const Eigen::Quaterniond R_base_odom = T_base_imu.rotation * filter.state.R_odom_imu.conjugate();
  Matrix6d out = Matrix6d::Identity();
  out.block<3, 3>(0, 0) = R_base_odom.toRotationMatrix();
  return out;
}

}  // namespace

void KeyframeRelation::carry(const Pose& T_odom_a, const Pose& T_odom_b, const Matrix6d& local) {
  walk_ = carry_drift(config_, walk_, T_odom_a, T_odom_b, local);
}

Matrix6d KeyframeRelation::covariance(const FilterSnapshot& filter) const {
  const Matrix6d J_base_imu = adjoint(T_base_imu_);  // e with T * Exp(e) for base from the same for the IMU
  const Matrix6d J_base_odom = odom_to_base(filter, T_base_imu_);
  const Matrix6d step = J_base_imu * motion_covariance(filter) * J_base_imu.transpose();
  return lasting_part(config_, step) + J_base_odom * walk_ * J_base_odom.transpose();
}

void KeyframeRelation::keep_before_new_map(FilterSnapshot& filter) {
  const Matrix6d J_odom_base = odom_to_base(filter, T_base_imu_).transpose();
  walk_ = J_odom_base * covariance(filter) * J_odom_base.transpose();
  filter.clone.covariance.setZero();
  filter.clone.cross.setZero();
}

void KeyframeRelation::break_off() { walk_ = kUnrelated * Matrix6d::Identity(); }

Matrix6d KeyframeRelation::take(FilterSnapshot& filter) {
  const Matrix6d relative = has_keyframe_ ? covariance(filter) : Matrix6d::Zero();
  take_clone(filter);
  walk_.setZero();
  has_keyframe_ = true;
  return relative;
}

UpDirection up_direction(const FilterSnapshot& filter, const Pose& T_base_imu) {
  const InertialState& state = filter.state;
  const Eigen::Vector3d up_imu = state.R_odom_imu.conjugate() * -state.gravity.normalized();
  // R_odom_imu Exp(d) turns up_imu by -d; gravity [+] d turns it by R_imu_odom B d.
  Eigen::Matrix<double, 3, 5> J_up_error;
  J_up_error.leftCols<3>() = -Eigen::Matrix3d::Identity();
  J_up_error.rightCols<2>() = state.R_odom_imu.conjugate().toRotationMatrix() * tangent_basis_s2(state.gravity);
  Eigen::Matrix<double, 5, 5> covariance;
  covariance << filter.covariance.topLeftCorner<3, 3>(), filter.covariance.block<3, 2>(I::kAttitude, I::kGravity),
      filter.covariance.block<2, 3>(I::kGravity, I::kAttitude), filter.covariance.bottomRightCorner<2, 2>();
  const Eigen::Matrix3d turn = J_up_error * covariance * J_up_error.transpose();
  const double across = turn.trace() - up_imu.dot(turn * up_imu);  // turning about `up` itself is no error of it
  return {T_base_imu.rotation * up_imu, std::sqrt(0.5 * across)};
}

}  // namespace slamd
