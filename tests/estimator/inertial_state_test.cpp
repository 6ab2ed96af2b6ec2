#include "estimator/filter/inertial_state.hpp"

#include <gtest/gtest.h>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using I = ErrorIndex;
using test::Random;

TEST(InertialState, TheErrorsRowsCoverTheStateWithoutOverlap) {
  std::array<int, I::kSize> used{};
  for (const int first : {I::kAttitude, I::kPosition, I::kExtrinsicRotation, I::kExtrinsicTranslation, I::kVelocity,
                          I::kGyroBias, I::kAccelBias})
    for (int i = 0; i < 3; ++i) ++used[static_cast<std::size_t>(first + i)];
  for (int i = 0; i < 2; ++i) ++used[static_cast<std::size_t>(I::kGravity + i)];
  for (const int count : used) EXPECT_EQ(count, 1);
}

TEST(InertialState, BoxminusUndoesBoxplus) {
  Random random{1};
  for (const double size : {0.0, 1e-9, 1e-4, 0.1, 0.5}) {
    for (int i = 0; i < 50; ++i) {
      const InertialState state = test::random_state(random);
      const ErrorVector e = test::random_error(random, size);
      EXPECT_LT((boxminus(boxplus(state, e), state) - e).norm(), 1e-13 + 1e-12 * size);
    }
  }
}

TEST(InertialState, BoxplusUndoesBoxminus) {
  Random random{2};
  for (int i = 0; i < 100; ++i) {
    const InertialState from = test::random_state(random);
    const InertialState to = test::random_state(random);
    const InertialState back = boxplus(from, boxminus(to, from));
    EXPECT_LT(boxminus(back, to).norm(), 1e-12);
    EXPECT_LT((back.p_odom_imu - to.p_odom_imu).norm(), 1e-13);
  }
}

TEST(InertialState, AttitudeIsPerturbedOnTheRight) {
  Random random{3};
  const InertialState state = test::random_state(random);
  ErrorVector e = ErrorVector::Zero();
  e.segment<3>(I::kAttitude) = Eigen::Vector3d{0.1, -0.2, 0.3};
  const Eigen::Quaterniond expected = state.R_odom_imu * exp_so3({0.1, -0.2, 0.3});
  EXPECT_LT(log_so3(expected.conjugate() * boxplus(state, e).R_odom_imu).norm(), 1e-14);
}

TEST(InertialState, JacobianOfBoxminusEqualsFiniteDifferencesOutsideGravity) {
  Random random{4};
  for (const double size : {0.0, 1e-8, 1e-3, 0.3}) {
    const InertialState from = test::random_state(random);
    const ErrorVector e = test::random_error(random, size);
    const InertialState state = boxplus(from, e);
    const auto moved = [&](const ErrorVector& d) { return boxminus(boxplus(state, d), from); };
    const ErrorCovariance numeric = test::central_differences<I::kSize, I::kSize>(moved);
    const ErrorCovariance analytic = boxminus_jacobian(e);
    EXPECT_LT((numeric - analytic).topLeftCorner(I::kGravity, I::kGravity).norm(), 1e-8) << "size " << size;
  }
}

TEST(InertialState, GravityBlockOfTheJacobianIsTheIdentityToFirstOrder) {
  Random random{5};
  for (const double size : {1e-4, 1e-3, 1e-2}) {
    const InertialState from = test::random_state(random);
    ErrorVector e = ErrorVector::Zero();
    e.segment<2>(I::kGravity) = Eigen::Vector2d{size, -size};
    const InertialState state = boxplus(from, e);
    const auto moved = [&](const ErrorVector& d) { return boxminus(boxplus(state, d), from); };
    const ErrorCovariance numeric = test::central_differences<I::kSize, I::kSize>(moved);
    EXPECT_LT((numeric - ErrorCovariance::Identity()).bottomRightCorner(2, 2).norm(), 2.0 * size);
  }
}

TEST(InertialState, LidarPoseIsTheChainOverTheImu) {
  Random random{6};
  const InertialState state = test::random_state(random);
  const Eigen::Vector3d p_lidar{1.0, 2.0, 3.0};
  const Eigen::Vector3d p_odom =
      state.R_odom_imu * (state.T_imu_lidar.rotation * p_lidar + state.T_imu_lidar.translation) + state.p_odom_imu;
  EXPECT_LT((state.T_odom_lidar() * p_lidar - p_odom).norm(), 1e-13);
}

}  // namespace
}  // namespace slamd
