#include "estimator/odometry/starter.hpp"

#include <gtest/gtest.h>

#include "tests/support/synthetic_drive.hpp"

namespace slamd {
namespace {

using test::SyntheticDrive;

class Start : public ::testing::Test {
 protected:
  static Scan scan_at(double begin_s) {
    Scan scan;
    scan.begin = SyntheticDrive::at(begin_s);
    scan.end = scan.arrival = SyntheticDrive::at(begin_s + 0.1);
    return scan;
  }
  void feed(double from_s, double to_s) {
    for (auto i = std::llround(from_s / 0.005); i < std::llround(to_s / 0.005); ++i) starter_.add(drive_.imu(i));
  }
  std::optional<InitialState> ask(double begin_s, bool imu_is_alive) {
    return starter_.state(scan_at(begin_s), imu_is_alive, false);
  }

  SyntheticDrive drive_{{.start_s = 60.0}};
  StarterConfig config_;
  Starter starter_{drive_.vehicle(), config_};
};

TEST_F(Start, AtRestItWaitsForTheWholeWindow) {
  feed(0.0, 0.6);
  EXPECT_FALSE(ask(0.5, true));
  EXPECT_FALSE(starter_.is_done());
  feed(0.6, 0.9);
  const std::optional<InitialState> first = ask(0.8, true);
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->at_rest);
  EXPECT_EQ(first->filter.time, SyntheticDrive::at(0.8));
  EXPECT_TRUE(starter_.is_done());
}

TEST_F(Start, TheLidarWaitsAGraceTimeForTheFirstImuSample) {
  double t = 0.0;
  for (; t + 0.1 < config_.imu_grace_s - 1e-9; t += 0.1) ASSERT_FALSE(ask(t, false)) << "at " << t;
  const std::optional<InitialState> first = ask(t, false);
  ASSERT_TRUE(first);
  EXPECT_FALSE(first->at_rest);
}

TEST_F(Start, AnImuThatComesWithinTheGraceTimeIsUsed) {
  EXPECT_FALSE(ask(0.0, false));
  EXPECT_FALSE(ask(0.4, false));
  feed(0.5, 0.8);
  EXPECT_FALSE(ask(0.7, true));
  feed(0.8, 1.5);
  const std::optional<InitialState> first = ask(1.4, true);
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->at_rest);
}

TEST_F(Start, AMovingVehicleIsNotWaitedFor) {
  drive_ = SyntheticDrive{{.start_s = -3.0}};
  feed(0.0, 0.35);
  const std::optional<InitialState> first = ask(0.2, true);
  ASSERT_TRUE(first);
  EXPECT_FALSE(first->at_rest);
}

TEST_F(Start, WhatABrokenImuSaidIsForgotten) {
  feed(0.0, 1.0);
  starter_.forget_samples();
  EXPECT_FALSE(ask(0.9, true));
  feed(1.2, 2.1);
  EXPECT_TRUE(ask(2.0, true));
}

TEST_F(Start, AfterClearEverythingBeginsAnewTheGraceTimeToo) {
  ask(0.0, false);
  ASSERT_TRUE(ask(1.0, false));
  starter_.clear();
  EXPECT_FALSE(starter_.is_done());
  EXPECT_FALSE(ask(2.0, false));
  EXPECT_TRUE(ask(3.0, false));
}

}  // namespace
}  // namespace slamd
