#include "estimator/filter/imu_propagation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using I = ErrorIndex;
using test::Random;

ImuInterval random_interval(Random& random, double length_s) {
  const Eigen::Vector3d gyro_rads = test::normal3(random, 1.5);
  return {from_seconds(length_s), gyro_rads, test::normal3(random, 8.0)};
}

TEST(ImuPropagation, TransitionEqualsFiniteDifferencesOfPropagate) {
  Random random{1};
  for (const double length_s : {1e-4, 0.005, 0.02, 0.1}) {
    for (int i = 0; i < 20; ++i) {
      const InertialState state = test::random_state(random);
      const ImuInterval interval = random_interval(random, length_s);
      const InertialState after = propagate(state, interval);
      const auto moved = [&](const ErrorVector& d) { return boxminus(propagate(boxplus(state, d), interval), after); };
      const ErrorCovariance numeric = test::central_differences<I::kSize, I::kSize>(moved);
      EXPECT_LT((transition(state, interval) - numeric).cwiseAbs().maxCoeff(), 1e-7) << "length " << length_s;
    }
  }
}

TEST(ImuPropagation, CovarianceIsTransformedByTheTransitionPlusNoise) {
  Random random{2};
  const ImuNoise noise;
  for (int i = 0; i < 20; ++i) {
    const InertialState state = test::random_state(random);
    const ImuInterval interval = random_interval(random, 0.005);
    const ErrorCovariance p = test::random_covariance(random, 0.1);
    ErrorCovariance moved = p;
    const ErrorCovariance F = transition(state, interval);
    propagate_covariance(F, noise, 0.005, moved);
    ErrorCovariance q = ErrorCovariance::Zero();
    propagate_covariance(F, noise, 0.005, q);
    EXPECT_LT((moved - F * p * F.transpose() - q).norm(), 1e-12 * p.norm() + 1e-15);
  }
}

TEST(ImuPropagation, NoiseOfOneIntervalHasTheDensitiesOfTheConfig) {
  Random random{3};
  const ImuNoise noise{.gyro_noise_rads_rthz = 2e-3,
                       .accel_noise_mps2_rthz = 3e-2,
                       .gyro_bias_walk_rads2_rthz = 4e-4,
                       .accel_bias_walk_mps3_rthz = 5e-3};
  ErrorCovariance q = ErrorCovariance::Zero();
  propagate_covariance(transition(test::random_state(random), random_interval(random, 0.005)), noise, 0.005, q);
  const auto expect = [&](int row, double density) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(q(row + i, row + i), density * density * 0.005, 1e-9 * density * density);
  };
  expect(I::kAttitude, 2e-3);
  expect(I::kVelocity, 3e-2);
  expect(I::kGyroBias, 4e-4);
  expect(I::kAccelBias, 5e-3);
  EXPECT_EQ((q.middleRows<6>(I::kExtrinsicRotation).norm()), 0.0) << "the extrinsic does not wander";
  EXPECT_EQ((q.bottomRows<2>().norm()), 0.0) << "nor does gravity";
}

/// Monte Carlo: accelerations that are constant over a hundredth of the interval, of the configured density.
TEST(ImuPropagation, WhiteAccelerationCouplesPositionAndVelocity) {
  Random random{6};
  constexpr double kLength_s = 0.1, kDensity = 0.3;
  constexpr int kSteps = 100, kRuns = 4'000;
  const double dt = kLength_s / kSteps;
  double pp = 0.0, pv = 0.0, vv = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    double p = 0.0, v = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double a = test::normal(random, kDensity / std::sqrt(dt));
      p += v * dt + 0.5 * a * dt * dt;
      v += a * dt;
    }
    pp += p * p / kRuns;
    pv += p * v / kRuns;
    vv += v * v / kRuns;
  }
  ErrorCovariance q = ErrorCovariance::Zero();
  const ErrorCovariance F = coast_transition(from_seconds(kLength_s), Eigen::Vector3d::Zero());
  propagate_covariance(F, {.accel_noise_mps2_rthz = kDensity}, kLength_s, q);
  EXPECT_NEAR(q(I::kPosition, I::kPosition) / pp, 1.0, 0.1);
  EXPECT_NEAR(q(I::kPosition, I::kVelocity) / pv, 1.0, 0.1);
  EXPECT_NEAR(q(I::kVelocity, I::kVelocity) / vv, 1.0, 0.1);
  EXPECT_EQ(q(I::kPosition, I::kVelocity + 1), 0.0);
}

/// The state that goes on with its velocity and its body rate, whatever biases and gravity say.
TEST(ImuPropagation, CoastTransitionEqualsFiniteDifferencesOfConstantVelocity) {
  Random random{7};
  const Eigen::Vector3d rate = test::normal3(random, 1.5);
  const InertialState state = test::random_state(random);
  const auto coast = [&](const InertialState& from) {
    InertialState to = from;
    to.R_odom_imu = from.R_odom_imu * exp_so3(0.02 * rate);
    to.p_odom_imu += 0.02 * from.v_odom_imu;
    return to;
  };
  const InertialState after = coast(state);
  const auto moved = [&](const ErrorVector& d) { return boxminus(coast(boxplus(state, d)), after); };
  const ErrorCovariance numeric = test::central_differences<I::kSize, I::kSize>(moved);
  EXPECT_LT((coast_transition(from_seconds(0.02), rate) - numeric).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(ImuPropagation, CovarianceStaysSymmetricAndPositiveOverTenThousandSteps) {
  Random random{4};
  InertialState state;
  ErrorCovariance p = ErrorCovariance::Zero();
  p.diagonal().tail<11>().setConstant(1e-4);
  for (int i = 0; i < 10'000; ++i) {
    const double t = 0.005 * i;
    const ImuInterval interval{from_seconds(0.005),
                               {std::sin(t), std::cos(2.0 * t), 0.5},
                               {2.0 * std::sin(3.0 * t), 0.3, kGravity_mps2 + std::cos(t)}};
    propagate_covariance(transition(state, interval), ImuNoise{}, 0.005, p);
    state = propagate(state, interval);
    state.p_odom_imu.setZero();
    if (i % 500 != 499) continue;
    ASSERT_EQ((p - p.transpose()).norm(), 0.0);
    const Eigen::SelfAdjointEigenSolver<ErrorCovariance> solver(p);
    ASSERT_GE(solver.eigenvalues().minCoeff(), -1e-12 * solver.eigenvalues().maxCoeff()) << "step " << i;
  }
  EXPECT_NEAR(state.R_odom_imu.norm(), 1.0, 1e-12);
}

/// A circle of radius 5 m at 2 m/s, the IMU's x forward: constant body rate and constant centripetal force.
struct Circle {
  double radius_m = 5.0;
  double speed_mps = 2.0;
  double rate() const { return speed_mps / radius_m; }
  InertialState at(double t) const {
    InertialState state;
    const double yaw = rate() * t;
    state.R_odom_imu = exp_so3({0.0, 0.0, yaw});
    state.p_odom_imu = radius_m * Eigen::Vector3d{std::sin(yaw), 1.0 - std::cos(yaw), 0.0};
    state.v_odom_imu = speed_mps * Eigen::Vector3d{std::cos(yaw), std::sin(yaw), 0.0};
    return state;
  }
  ImuInterval interval(double length_s) const {
    return {from_seconds(length_s), {0.0, 0.0, rate()}, {0.0, speed_mps * rate(), kGravity_mps2}};
  }
};

double error_after_one_circle(int steps) {
  const Circle circle;
  const double period_s = 2.0 * 3.14159265358979 / circle.rate();
  InertialState state = circle.at(0.0);
  const ImuInterval interval = circle.interval(period_s / steps);
  for (int i = 0; i < steps; ++i) state = propagate(state, interval);
  return (state.p_odom_imu - circle.at(to_seconds(interval.length) * steps).p_odom_imu).norm();
}

TEST(ImuPropagation, ACircleClosesAndHalvingTheStepQuartersItsError) {
  const double coarse = error_after_one_circle(1'000);
  const double fine = error_after_one_circle(2'000);
  EXPECT_LT(fine, 1e-3);
  EXPECT_NEAR(coarse / fine, 4.0, 0.3) << "the mid-point rule is of second order";
}

TEST(ImuPropagation, BiasesAreTakenOutOfTheSamples) {
  Random random{5};
  InertialState state = test::random_state(random);
  const ImuInterval interval = random_interval(random, 0.01);
  InertialState without = state;
  without.gyro_bias.setZero();
  without.accel_bias.setZero();
  const ImuInterval corrected{interval.length, interval.gyro_rads - state.gyro_bias,
                              interval.accel_mps2 - state.accel_bias};
  const InertialState a = propagate(state, interval);
  const InertialState b = propagate(without, corrected);
  EXPECT_LT((boxminus(a, b).head<I::kGyroBias>().norm()), 1e-13);
}

TEST(ImuPropagation, FreeFallFollowsGravity) {
  InertialState state;
  for (int i = 0; i < 100; ++i)
    state = propagate(state, {from_seconds(0.01), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  EXPECT_NEAR(state.p_odom_imu.z(), -0.5 * kGravity_mps2, 1e-9);
  EXPECT_NEAR(state.v_odom_imu.z(), -kGravity_mps2, 1e-9);
}

}  // namespace
}  // namespace slamd
