#include "estimator/odometry/standstill.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using I = ErrorIndex;
using test::Random;

constexpr HostTime kEnd{std::chrono::seconds{101}};

/// A second of samples at 200 Hz that ends at kEnd, with white noise and a sine on the vertical force.
ImuBuffer one_second(double gyro_std_rads, double accel_std_mps2, double shake_mps2 = 0.0) {
  Random random{3};
  ImuBuffer samples;
  for (int i = -199; i <= 0; ++i) {
    const double t = i * 0.005;
    ImuSample sample;
    sample.time = sample.arrival = kEnd + from_seconds(t);
    sample.gyro_rads = Eigen::Vector3d{0.01, -0.02, 0.005} + test::normal3(random, gyro_std_rads);
    sample.accel_mps2 = Eigen::Vector3d{0.1, 0.0, 9.8 + shake_mps2 * std::sin(60.0 * t)} + test::normal3(random, accel_std_mps2);
    samples.push(sample);
  }
  return samples;
}

TEST(Standstill, AQuietImuStands) {
  EXPECT_TRUE(is_standing({}, one_second(0.001, 0.01), kEnd));
  EXPECT_TRUE(is_standing({}, one_second(0.001, 0.01), kEnd - from_seconds(0.3)));
}

TEST(Standstill, AVehicleThatShakesIsNotSaidToStand) {
  EXPECT_FALSE(is_standing({}, one_second(0.001, 0.01, 0.1), kEnd));
  EXPECT_FALSE(is_standing({}, one_second(0.01, 0.01), kEnd));
  EXPECT_FALSE(is_standing({}, one_second(0.001, 0.1), kEnd));
}

TEST(Standstill, NorIsOneWhoseSamplesDoNotReachSoFar) {
  const ImuBuffer samples = one_second(0.001, 0.01);
  EXPECT_FALSE(is_standing({}, ImuBuffer{}, kEnd));
  EXPECT_FALSE(is_standing({}, samples, kEnd + from_seconds(0.2)));
  EXPECT_FALSE(is_standing({}, samples, kEnd - from_seconds(0.8))) << "the window begins before the samples";
}

TEST(Standstill, NorOneWithAGapInTheWindow) {
  ImuBuffer samples = one_second(0.001, 0.01);
  samples.drop_after(kEnd - from_seconds(0.3));
  ImuSample late = samples.newest();
  for (int i = -40; i <= 0; ++i) {
    late.time = kEnd + from_seconds(i * 0.005);
    late.accel_mps2.x() += 1e-6;
    samples.push(late);
  }
  EXPECT_FALSE(is_standing({}, samples, kEnd));
}

/// Slow and unsure of it, all states correlated.
FilterSnapshot creeping(Random& random) {
  FilterSnapshot filter;
  filter.state = test::random_state(random);
  filter.covariance = test::random_covariance(random, 0.05);
  filter.state.v_odom_imu = {0.02, -0.01, 0.015};
  filter.clone.cross.setConstant(1e-3);
  return filter;
}

TEST(Standstill, TheUpdateIsThatOfAMeasuredVelocityOfZero) {
  Random random{5};
  const StandstillConfig config;
  const FilterSnapshot before = creeping(random);
  FilterSnapshot after = before;
  ASSERT_TRUE(update_standstill(config, after));
  // In information form, where nothing is shared with the code under test.
  ErrorCovariance information = before.covariance.inverse();
  information.block<3, 3>(I::kVelocity, I::kVelocity).diagonal().array() += 1.0 / (config.sigma_mps * config.sigma_mps);
  const ErrorCovariance expected = information.inverse();
  EXPECT_LT((after.covariance - expected).norm(), 1e-6 * expected.norm());
  const ErrorVector moved = boxminus(after.state, before.state);
  const ErrorVector expected_move =
      -expected.middleCols<3>(I::kVelocity) * before.state.v_odom_imu / (config.sigma_mps * config.sigma_mps);
  EXPECT_LT((moved - expected_move).norm(), 1e-6);
  EXPECT_LT(after.state.v_odom_imu.norm(), 0.3 * before.state.v_odom_imu.norm());
  const CloneCovariance cross = expected * before.covariance.inverse() * before.clone.cross;  // (I - K H) X
  EXPECT_LT((after.clone.cross - cross).norm(), 1e-6 * cross.norm());
}

TEST(Standstill, AStateThatMovesIsNotStopped) {
  Random random{7};
  FilterSnapshot fast = creeping(random);
  fast.state.v_odom_imu = {0.6, 0.0, 0.0};
  FilterSnapshot sure = creeping(random);
  sure.covariance *= 1e-6;
  sure.state.v_odom_imu = {0.1, 0.0, 0.0};
  for (const FilterSnapshot& before : {fast, sure}) {
    FilterSnapshot after = before;
    EXPECT_FALSE(update_standstill({}, after));
    EXPECT_EQ(after.covariance, before.covariance);
    EXPECT_EQ(after.state.v_odom_imu, before.state.v_odom_imu);
  }
}

}  // namespace
}  // namespace slamd
