#include "estimator/odometry/base_state.hpp"

#include <gtest/gtest.h>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using I = ErrorIndex;
using test::Random;

FilterSnapshot random_snapshot(Random& random) {
  FilterSnapshot snapshot;
  snapshot.time = from_ns<HostTime>(123'456'789);
  snapshot.state = test::random_state(random);
  snapshot.covariance = test::random_covariance(random, 0.1);
  snapshot.angular_velocity_rads = test::normal3(random);
  return snapshot;
}

/// Error of the base's pose: position in odom, attitude as right perturbation in base.
Eigen::Matrix<double, 6, 1> pose_error(const Pose& to, const Pose& from) {
  Eigen::Matrix<double, 6, 1> e;
  e << to.translation - from.translation, log_so3(from.rotation.conjugate() * to.rotation);
  return e;
}

TEST(BaseState, PoseIsTheImusPoseMovedByTheExtrinsic) {
  Random random{1};
  const FilterSnapshot snapshot = random_snapshot(random);
  const Pose T_base_imu = test::random_pose(random);
  const NavState base = base_state(snapshot, T_base_imu);
  const Pose back = base.T_odom_base * T_base_imu;
  EXPECT_LT(pose_error(back, snapshot.state.T_odom_imu()).norm(), 1e-13);
  EXPECT_EQ(base.time, snapshot.time);
}

TEST(BaseState, TwistEqualsTheDerivativeOfThePose) {
  Random random{2};
  const FilterSnapshot snapshot = random_snapshot(random);
  const Pose T_base_imu = test::random_pose(random);
  const auto pose_at = [&](double t) {
    FilterSnapshot later = snapshot;
    later.state.R_odom_imu = snapshot.state.R_odom_imu * exp_so3(t * snapshot.angular_velocity_rads);
    later.state.p_odom_imu += t * snapshot.state.v_odom_imu;
    return base_state(later, T_base_imu).T_odom_base;
  };
  const Eigen::Matrix<double, 6, 1> rate = pose_error(pose_at(1e-5), pose_at(-1e-5)) / 2e-5;
  const NavState base = base_state(snapshot, T_base_imu);
  EXPECT_LT((rate.head<3>() - base.velocity_mps).norm(), 1e-7);
  EXPECT_LT((rate.tail<3>() - base.angular_velocity_rads).norm(), 1e-7);
}

TEST(BaseState, CovarianceIsMappedByTheJacobianOfThePose) {
  Random random{3};
  for (int i = 0; i < 20; ++i) {
    const FilterSnapshot snapshot = random_snapshot(random);
    const Pose T_base_imu = test::random_pose(random);
    const Pose nominal = base_state(snapshot, T_base_imu).T_odom_base;
    const auto moved = [&](const ErrorVector& d) {
      FilterSnapshot other = snapshot;
      other.state = boxplus(snapshot.state, d);
      return pose_error(base_state(other, T_base_imu).T_odom_base, nominal);
    };
    const Eigen::Matrix<double, 6, I::kSize> J = test::central_differences<6, I::kSize>(moved);
    const Matrix6d expected = J * snapshot.covariance * J.transpose();
    EXPECT_LT((base_state(snapshot, T_base_imu).covariance - expected).norm(), 1e-8 * expected.norm());
  }
}

TEST(BaseState, UncertaintyOfTheMapIsAdded) {
  Random random{4};
  FilterSnapshot snapshot = random_snapshot(random);
  const Pose T_base_imu = test::random_pose(random);
  const Matrix6d without = base_state(snapshot, T_base_imu).covariance;
  snapshot.map_covariance = 0.01 * Matrix6d::Identity();
  const Matrix6d with = base_state(snapshot, T_base_imu).covariance;
  EXPECT_LT((with - without - snapshot.map_covariance).norm(), 1e-14);
}

TEST(BaseState, BiasesAreHandedOnInTheImuFrame) {
  Random random{5};
  const FilterSnapshot snapshot = random_snapshot(random);
  const NavState base = base_state(snapshot, test::random_pose(random));
  EXPECT_EQ(base.gyro_bias_rads, snapshot.state.gyro_bias);
  EXPECT_EQ(base.accel_bias_mps2, snapshot.state.accel_bias);
  EXPECT_EQ(base.status, TrackingStatus::kInitialising);
  EXPECT_EQ(base.reasons, 0U);
}

}  // namespace
}  // namespace slamd
