#include "estimator/odometry/dead_reckoning.hpp"

#include <gtest/gtest.h>

#include "tests/support/synthetic_drive.hpp"

namespace slamd {
namespace {

using I = ErrorIndex;
using test::SyntheticDrive;

constexpr auto kIgnore = [](const FilterSnapshot&) {};

/// The true state of the drive's IMU at t, with biases known and little covariance.
FilterSnapshot truth_at(const SyntheticDrive& drive, double t) {
  const auto pose = [&](double s) { return drive.T_world_base(SyntheticDrive::at(s)) * drive.vehicle().T_base_imu; };
  FilterSnapshot filter;
  filter.time = SyntheticDrive::at(t);
  filter.state.R_odom_imu = pose(t).rotation;
  filter.state.p_odom_imu = pose(t).translation;
  filter.state.v_odom_imu = (pose(t + 1e-4).translation - pose(t - 1e-4).translation) / 2e-4;
  filter.state.gyro_bias = {0.004, -0.003, 0.002};
  filter.state.accel_bias = {0.03, -0.04, 0.05};
  filter.covariance = 1e-8 * ErrorCovariance::Identity();
  filter.angular_velocity_rads = log_so3(pose(t - 1e-3).rotation.conjugate() * pose(t + 1e-3).rotation) / 2e-3;
  return filter;
}

ImuBuffer samples_without(const SyntheticDrive& drive, double gap_from_s, double gap_to_s) {
  ImuBuffer buffer;
  for (int i = 0; i < 1'200; ++i)
    if (0.005 * i <= gap_from_s || 0.005 * i >= gap_to_s) buffer.push(drive.imu(i));
  return buffer;
}

double position_sigma(const FilterSnapshot& filter) {
  return std::sqrt(filter.covariance.block<3, 3>(I::kPosition, I::kPosition).trace());
}

TEST(DeadReckoning, OverSamplesTheDriveIsFollowed) {
  const SyntheticDrive drive;
  const ImuBuffer samples = samples_without(drive, 9.0, 9.0);
  FilterSnapshot filter = truth_at(drive, 3.0);
  const DeadReckoningSummary summary =
      DeadReckoning{DeadReckoningConfig{}}.advance(samples, SyntheticDrive::at(5.0), filter, kIgnore);
  EXPECT_EQ(filter.time, SyntheticDrive::at(5.0));
  EXPECT_LT((filter.state.p_odom_imu - truth_at(drive, 5.0).state.p_odom_imu).norm(), 0.05);
  EXPECT_LT(log_so3(filter.state.R_odom_imu.conjugate() * truth_at(drive, 5.0).state.R_odom_imu).norm(), 0.005);
  EXPECT_NEAR(summary.measured_s, 2.0, 1e-9);
  EXPECT_EQ(summary.coasted_s, 0.0);
  EXPECT_FALSE(summary.clipped);
}

TEST(DeadReckoning, OverAGapVelocityAndRateAreKept) {
  const SyntheticDrive drive;
  const ImuBuffer samples = samples_without(drive, 4.0, 5.0);
  FilterSnapshot filter = truth_at(drive, 4.0);
  const Eigen::Vector3d velocity = filter.state.v_odom_imu, rate = filter.angular_velocity_rads;
  const Eigen::Quaterniond rotation = filter.state.R_odom_imu;
  const Eigen::Vector3d position = filter.state.p_odom_imu;
  const DeadReckoningSummary summary =
      DeadReckoning{DeadReckoningConfig{}}.advance(samples, SyntheticDrive::at(4.5), filter, kIgnore);
  EXPECT_NEAR(summary.coasted_s, 0.5, 1e-9);
  EXPECT_LT((filter.state.v_odom_imu - velocity).norm(), 1e-9);
  EXPECT_LT((filter.state.p_odom_imu - position - 0.5 * velocity).norm(), 1e-9);
  EXPECT_LT(log_so3((rotation * exp_so3(0.5 * rate)).conjugate() * filter.state.R_odom_imu).norm(), 1e-9);
}

TEST(DeadReckoning, AGapIsLessCertainThanSamples) {
  const SyntheticDrive drive;
  FilterSnapshot with = truth_at(drive, 4.0), without = with;
  const DeadReckoning dead_reckoning{DeadReckoningConfig{}};
  dead_reckoning.advance(samples_without(drive, 9.0, 9.0), SyntheticDrive::at(4.8), with, kIgnore);
  dead_reckoning.advance(samples_without(drive, 4.0, 5.0), SyntheticDrive::at(4.8), without, kIgnore);
  EXPECT_GT(position_sigma(without), 5.0 * position_sigma(with));
  const double error_m = (without.state.p_odom_imu - truth_at(drive, 4.8).state.p_odom_imu).norm();
  EXPECT_LT(error_m, 3.0 * position_sigma(without)) << "the covariance covers the error of the model";
}

TEST(DeadReckoning, ClippedSamplesAreSaidAndBelievedLess) {
  const SyntheticDrive drive;
  ImuBuffer clean, clipped;
  for (int i = 0; i < 1'000; ++i) {
    ImuSample sample = drive.imu(i);
    clean.push(sample);
    sample.clipped = i > 820 && i < 840;
    clipped.push(sample);
  }
  FilterSnapshot a = truth_at(drive, 4.0), b = a;
  const DeadReckoning dead_reckoning{DeadReckoningConfig{}};
  EXPECT_FALSE(dead_reckoning.advance(clean, SyntheticDrive::at(4.5), a, kIgnore).clipped);
  EXPECT_TRUE(dead_reckoning.advance(clipped, SyntheticDrive::at(4.5), b, kIgnore).clipped);
  EXPECT_GT(position_sigma(b), 2.0 * position_sigma(a));
  EXPECT_LT((a.state.p_odom_imu - b.state.p_odom_imu).norm(), 1e-12);
}

TEST(DeadReckoning, KnotsAreGivenInOrderUpToTheEnd) {
  const SyntheticDrive drive;
  FilterSnapshot filter = truth_at(drive, 4.0);
  HostTime last = filter.time;
  const auto check = [&](const FilterSnapshot& at) {
    EXPECT_GT(at.time, last);
    last = at.time;
  };
  DeadReckoning{DeadReckoningConfig{}}.advance(samples_without(drive, 4.3, 4.6), SyntheticDrive::at(4.9), filter, check);
  EXPECT_EQ(last, SyntheticDrive::at(4.9));
}

TEST(DeadReckoning, TimeDoesNotRunBackwards) {
  const SyntheticDrive drive;
  FilterSnapshot filter = truth_at(drive, 4.0);
  DeadReckoning{DeadReckoningConfig{}}.advance(samples_without(drive, 9, 9), SyntheticDrive::at(3.0), filter, kIgnore);
  EXPECT_EQ(filter.time, SyntheticDrive::at(4.0));
}

}  // namespace
}  // namespace slamd
