#include "estimator/odometry/map_drift.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using test::Random;
using Vector6d = Eigen::Matrix<double, 6, 1>;

const MapDriftConfig kStill{.position_m_rtm = 0.0, .attitude_rad_rtm = 0.0};
const Matrix6d kNothing = Matrix6d::Zero();

Vector6d pose_error(const Pose& to, const Pose& from) {
  Vector6d e;
  e << to.translation - from.translation, log_so3(from.rotation.conjugate() * to.rotation);
  return e;
}

TEST(MapDrift, AnErrorBehindIsCarriedAlongByTheMotion) {
  Random random{1};
  for (int i = 0; i < 20; ++i) {
    const Pose T_odom_a = test::random_pose(random), T_odom_b = test::random_pose(random);
    const Pose T_a_b = T_odom_a.inverse() * T_odom_b;
    const auto moved = [&](const Vector6d& d) {
      const Pose wrong{T_odom_a.rotation * exp_so3(d.tail<3>()), T_odom_a.translation + d.head<3>()};
      return pose_error(wrong * T_a_b, T_odom_b);
    };
    const Matrix6d J = test::central_differences<6, 6>(moved);
    const Matrix6d drift = test::random_covariance(random, 0.1).topLeftCorner<6, 6>();
    const Matrix6d expected = J * drift * J.transpose();
    EXPECT_LT((carry_drift(kStill, drift, T_odom_a, T_odom_b, kNothing) - expected).norm(), 1e-7 * expected.norm());
  }
}

TEST(MapDrift, AtRestNothingDrifts) {
  Random random{2};
  const Pose T_odom_base = test::random_pose(random);
  const Matrix6d drift = first_drift(MapDriftConfig{});
  const Matrix6d local = test::random_covariance(random, 0.1).topLeftCorner<6, 6>();
  EXPECT_LT((carry_drift(MapDriftConfig{}, drift, T_odom_base, T_odom_base, local) - drift).norm(), 1e-18);
}

TEST(MapDrift, AMapBegunWhileMovingIsWorthLessTheLessTheVelocityIsKnown) {
  const MapDriftConfig config{.moving_velocity_share = 0.01, .moving_skew_s = 0.5, .moving_lever_m = 50.0};
  FilterSnapshot filter;
  EXPECT_EQ(skew_drift(config, filter), Matrix6d::Zero()) << "at rest and sure of it";
  filter.covariance.diagonal().segment<3>(ErrorIndex::kVelocity).setConstant(0.04);
  const Matrix6d unsure = skew_drift(config, filter);
  EXPECT_NEAR(std::sqrt(unsure(0, 0)), 0.1, 1e-12);
  EXPECT_NEAR(std::sqrt(unsure(3, 3)), 0.1 / 50.0, 1e-12);
  filter.state.v_odom_imu = {10.0, 0.0, 0.0};
  EXPECT_GT(skew_drift(config, filter)(0, 0), unsure(0, 0));
}

TEST(MapDrift, TheWalkGrowsWithTheRootOfTheDistanceWhateverItsSteps) {
  const MapDriftConfig config{.position_m_rtm = 1e-3, .attitude_rad_rtm = 0.0};
  for (const int steps : {10, 1'000}) {
    Matrix6d drift = Matrix6d::Zero();
    Pose T_odom_base;
    for (int i = 0; i < steps; ++i) {
      Pose next = T_odom_base;
      next.translation.x() += 100.0 / steps;
      drift = carry_drift(config, drift, T_odom_base, next, kNothing);
      T_odom_base = next;
    }
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::sqrt(drift(axis, axis)), 0.01, 1e-9);
  }
}

TEST(MapDrift, AMapMadeByUnsurePosesTakesOnTheirCovariance) {
  const MapDriftConfig config{.renewal_m = 20.0, .position_m_rtm = 0.0, .attitude_rad_rtm = 0.0};
  Matrix6d local = Matrix6d::Zero();
  local(0, 0) = 0.25;
  Matrix6d drift = Matrix6d::Zero();
  Pose T_odom_base;
  for (int i = 0; i < 40; ++i) {
    Pose next = T_odom_base;
    next.translation.x() += 0.5;
    drift = carry_drift(config, drift, T_odom_base, next, local);
    T_odom_base = next;
  }
  EXPECT_NEAR(drift(0, 0), 0.25, 1e-9) << "after one renewal the map is as unsure as the poses were";
  EXPECT_EQ(drift(1, 1), 0.0);
  Pose far = T_odom_base;
  far.translation.x() += 1e3;
  EXPECT_NEAR(carry_drift(config, drift, T_odom_base, far, local)(0, 0), 0.5, 1e-9) << "one step renews it once";
}

TEST(MapDrift, TheWalkOfTheHeadingMovesThePositionSideways) {
  const MapDriftConfig config{.position_m_rtm = 0.0, .attitude_rad_rtm = 1e-4};
  Matrix6d drift = Matrix6d::Zero();
  Pose T_odom_base;
  for (int i = 0; i < 1'000; ++i) {
    Pose next = T_odom_base;
    next.translation.x() += 0.1;
    drift = carry_drift(config, drift, T_odom_base, next, kNothing);
    T_odom_base = next;
  }
  // Integral of a walk: sigma^2 = q^2 s^3 / 3.
  EXPECT_NEAR(std::sqrt(drift(1, 1)), 1e-4 * std::sqrt(1e6 / 3.0), 1e-4);
  EXPECT_LT(drift(0, 0), 1e-15) << "along the way a heading does nothing";
  EXPECT_GT(drift(1, 5), 0.0) << "left of the way when turned to the left";
}

}  // namespace
}  // namespace slamd
