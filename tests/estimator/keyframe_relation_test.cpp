#include "estimator/odometry/keyframe_relation.hpp"

#include <gtest/gtest.h>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using I = ErrorIndex;
using test::Random;
using Vector6d = Eigen::Matrix<double, 6, 1>;

FilterSnapshot random_filter(Random& random) {
  FilterSnapshot filter;
  filter.state = test::random_state(random);
  filter.covariance = test::random_covariance(random, 0.05);
  return filter;
}

/// Everything that the filter says adds up.
constexpr MapDriftConfig kNothingHeld{.held_position_m = 1e-9, .held_attitude_rad = 1e-9};

Pose base_of(const InertialState& state, const Pose& T_base_imu) { return state.T_odom_imu() * T_base_imu.inverse(); }

TEST(KeyframeRelation, TheFirstKeyframeHasNone) {
  Random random{1};
  FilterSnapshot filter = random_filter(random);
  KeyframeRelation relation{MapDriftConfig{}, test::random_pose(random)};
  relation.carry(test::random_pose(random), test::random_pose(random), Matrix6d::Zero());
  EXPECT_EQ(relation.take(filter), Matrix6d::Zero());
}

TEST(KeyframeRelation, WithoutMotionOrMeasurementNothingIsUnknown) {
  Random random{2};
  FilterSnapshot filter = random_filter(random);
  KeyframeRelation relation{MapDriftConfig{}, test::random_pose(random)};
  relation.take(filter);
  EXPECT_LT(relation.take(filter).norm(), 1e-14);
}

TEST(KeyframeRelation, IsTheCovarianceOfTheBasesMotion) {
  Random random{3};
  const Pose T_base_imu = test::random_pose(random);
  FilterSnapshot filter = random_filter(random);
  KeyframeRelation relation{kNothingHeld, T_base_imu};
  relation.take(filter);
  const InertialState before = filter.state;
  filter.state = boxplus(filter.state, test::random_error(random, 0.5));
  filter.clone.cross.setZero();  // two poses that share nothing
  const Pose estimate = base_of(before, T_base_imu).inverse() * base_of(filter.state, T_base_imu);
  const auto motion = [&](const Eigen::Matrix<double, 12, 1>& d) {
    ErrorVector of_state = ErrorVector::Zero(), of_clone = ErrorVector::Zero();
    of_state.head<6>() = d.head<6>();
    of_clone.head<6>() = d.tail<6>();
    const Pose moved = base_of(boxplus(before, of_clone), T_base_imu).inverse() *
                       base_of(boxplus(filter.state, of_state), T_base_imu);
    const Pose error = estimate.inverse() * moved;
    Vector6d e;
    e << error.translation, log_so3(error.rotation);
    return e;
  };
  const Eigen::Matrix<double, 6, 12> J = test::central_differences<6, 12>(motion);
  const Matrix6d p = filter.covariance.topLeftCorner<6, 6>();
  const Matrix6d expected =
      J.leftCols<6>() * p * J.leftCols<6>().transpose() + J.rightCols<6>() * p * J.rightCols<6>().transpose();
  EXPECT_LT((relation.take(filter) - expected).norm(), 1e-7 * expected.norm());
}

TEST(KeyframeRelation, NoiseAboutAMapThatHoldsThePoseDoesNotAddUp) {
  KeyframeRelation relation{MapDriftConfig{}, Pose{}};
  FilterSnapshot filter;
  filter.covariance.diagonal().head<3>().setConstant(1e-4 * 1e-4);  // rad^2
  filter.covariance.diagonal().segment<3>(I::kPosition).setConstant(1e-3 * 1e-3);
  relation.take(filter);
  filter.clone.cross.setZero();
  EXPECT_LT(relation.take(filter).norm(), 1e-15);
}

TEST(KeyframeRelation, WhatNoScanHoldsAddsUpAlongThatDirectionAlone) {
  KeyframeRelation relation{MapDriftConfig{}, Pose{}};
  FilterSnapshot filter;
  relation.take(filter);
  filter.covariance.diagonal().segment<3>(I::kPosition) << 1.0, 1e-6, 1e-6;
  const Matrix6d covariance = relation.take(filter);
  EXPECT_NEAR(covariance(0, 0), 1.0, 1e-4);
  EXPECT_LT(covariance(1, 1) + covariance(2, 2), 1e-12);
}

TEST(KeyframeRelation, TheMapsWalkIsToldInTheKeyframesOwnFrame) {
  const MapDriftConfig config{.position_m_rtm = 0.0, .attitude_rad_rtm = 1e-3};
  KeyframeRelation relation{config, Pose{}};
  FilterSnapshot filter;
  filter.state.R_odom_imu = exp_so3({0.0, 0.0, 0.5 * 3.14159265358979});  // looks along odom's y
  relation.take(filter);
  Pose from = filter.state.T_odom_imu();
  for (int i = 0; i < 100; ++i) {
    filter.state.p_odom_imu.y() += 0.1;
    relation.carry(from, filter.state.T_odom_imu(), Matrix6d::Zero());
    from = filter.state.T_odom_imu();
  }
  const Matrix6d covariance = relation.take(filter);
  EXPECT_LT(covariance(0, 0), 1e-15) << "forwards";
  EXPECT_NEAR(covariance(1, 1), 1e-6 * 1'000.0 / 3.0, 1e-5) << "sideways";
}

TEST(KeyframeRelation, ANewMapKeepsWhatTheOldOneWasWorth) {
  Random random{4};
  const Pose T_base_imu = test::random_pose(random);
  FilterSnapshot filter = random_filter(random);
  KeyframeRelation relation{MapDriftConfig{}, T_base_imu}, undisturbed{MapDriftConfig{}, T_base_imu};
  FilterSnapshot twin = filter;
  relation.take(filter);
  undisturbed.take(twin);
  filter.state = twin.state = boxplus(filter.state, test::random_error(random, 0.5));
  filter.clone.cross *= 0.5;
  twin.clone.cross *= 0.5;
  relation.keep_before_new_map(filter);
  filter.covariance.topRows<6>().setZero();
  filter.covariance.leftCols<6>().setZero();
  const Matrix6d expected = undisturbed.take(twin);
  EXPECT_LT((relation.take(filter) - expected).norm(), 1e-12 * expected.norm());
}

TEST(KeyframeRelation, AfterABreakTheRelationIsWorthless) {
  Random random{5};
  FilterSnapshot filter = random_filter(random);
  KeyframeRelation relation{MapDriftConfig{}, Pose{}};
  relation.take(filter);
  relation.break_off();
  EXPECT_GT(relation.take(filter).diagonal().minCoeff(), 1e5);
}

TEST(UpDirection, ItsSigmaIsThatOfManySamples) {
  Random random{6};
  FilterSnapshot filter = random_filter(random);
  filter.covariance = test::random_covariance(random, 0.01);
  const Pose T_base_imu = test::random_pose(random);
  const UpDirection up = up_direction(filter, T_base_imu);
  EXPECT_NEAR(up.up_base.norm(), 1.0, 1e-12);
  const ErrorCovariance root = filter.covariance.llt().matrixL();
  constexpr int kRuns = 4'000;
  double squared = 0.0;
  for (int i = 0; i < kRuns; ++i) {
    FilterSnapshot other;
    other.state = boxplus(filter.state, root * test::random_error(random, 1.0));
    squared += (up_direction(other, T_base_imu).up_base - up.up_base).squaredNorm() / kRuns;
  }
  EXPECT_NEAR(std::sqrt(0.5 * squared) / up.sigma_rad, 1.0, 0.05);
}

TEST(UpDirection, TurningAboutItIsNoErrorOfIt) {
  FilterSnapshot filter;
  filter.covariance(I::kAttitude + 2, I::kAttitude + 2) = 1.0;
  const UpDirection up = up_direction(filter, Pose{});
  EXPECT_EQ(up.up_base, Eigen::Vector3d::UnitZ());
  EXPECT_LT(up.sigma_rad, 1e-9);
}

}  // namespace
}  // namespace slamd
