#include "estimator/filter/odom_frame.hpp"

#include <gtest/gtest.h>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using I = ErrorIndex;
using test::Random;

/// The state told in the odom in which its IMU is at T_odom_imu.
InertialState told_in(const Pose& T_odom_imu, const InertialState& state) {
  InertialState out = state;
  const Eigen::Quaterniond R_new_old = T_odom_imu.rotation * state.R_odom_imu.conjugate();
  out.R_odom_imu = T_odom_imu.rotation;
  out.p_odom_imu = T_odom_imu.translation;
  out.v_odom_imu = R_new_old * state.v_odom_imu;
  out.gravity = R_new_old * state.gravity;
  return out;
}

TEST(OdomFrame, WhatTheVehicleFeelsIsTheSameInTheNewFrame) {
  Random random{1};
  FilterSnapshot filter;
  filter.state = test::random_state(random);
  const InertialState before = filter.state;
  const Pose T_odom_imu = test::random_pose(random);
  define_odom(T_odom_imu, filter);
  const InertialState& after = filter.state;
  EXPECT_LT((after.R_odom_imu.conjugate() * after.v_odom_imu - before.R_odom_imu.conjugate() * before.v_odom_imu).norm(),
            1e-12);
  EXPECT_LT((after.R_odom_imu.conjugate() * after.gravity - before.R_odom_imu.conjugate() * before.gravity).norm(), 1e-12);
  EXPECT_EQ(after.p_odom_imu, T_odom_imu.translation);
}

TEST(OdomFrame, CovarianceIsMappedByTheJacobianOfTheChange) {
  Random random{2};
  for (int i = 0; i < 20; ++i) {
    FilterSnapshot filter;
    filter.state = test::random_state(random);
    filter.covariance = test::random_covariance(random, 0.05);
    const InertialState before = filter.state;
    const Pose T_odom_imu = test::random_pose(random);
    const InertialState nominal = told_in(T_odom_imu, before);
    const auto moved = [&](const ErrorVector& d) { return boxminus(told_in(T_odom_imu, boxplus(before, d)), nominal); };
    const ErrorCovariance J = test::central_differences<I::kSize, I::kSize>(moved);
    const ErrorCovariance expected = J * filter.covariance * J.transpose();
    define_odom(T_odom_imu, filter);
    EXPECT_LT((filter.covariance - expected).norm(), 1e-7 * expected.norm());
    EXPECT_EQ(filter.covariance.topRows<6>().norm(), 0.0) << "the pose is exact by definition";
  }
}

}  // namespace
}  // namespace slamd
