#include "estimator/odometry/imu_sanity.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using test::Random;

/// 200 Hz; the values are up to the test.
class Sanity : public ::testing::Test {
 protected:
  ImuSample next() {
    ImuSample sample{.time = now_, .arrival = now_};
    sample.gyro_rads = test::normal3(random_, 0.002);
    sample.accel_mps2 = Eigen::Vector3d{0.0, 0.0, 9.8} + test::normal3(random_, 0.02);
    now_ += std::chrono::milliseconds{5};
    return sample;
  }
  void run_good(double seconds) {
    for (double t = 0.0; t < seconds; t += 0.005) last_ = sanity_.look(good_ = next());
  }
  /// Samples as change() makes them until the fault is found; how long that took.
  template <class Change>
  double time_to_fault(const Change& change, double limit_s = 5.0) {
    for (int i = 1; i * 0.005 < limit_s; ++i) {
      ImuSample sample = next();
      change(sample);
      last_ = sanity_.look(sample);
      if (!sanity_.is_sane()) return i * 0.005;
    }
    return limit_s;
  }

  ImuSanityConfig config_;
  ImuSanity sanity_{config_};
  Random random_{5};
  HostTime now_ = from_ns<HostTime>(1'000'000'000);
  ImuSample good_;
  ImuFault last_ = ImuFault::kNone;
};

TEST_F(Sanity, NoiseIsNoFault) {
  for (int i = 0; i < 20'000; ++i) ASSERT_EQ(sanity_.look(next()), ImuFault::kNone);
  EXPECT_FALSE(sanity_.is_suspect());
}

TEST_F(Sanity, TheSameValuesAgainAndAgainAreAStuckSensor) {
  run_good(1.0);
  const ImuSample stuck = good_;
  const double needed = time_to_fault([&](ImuSample& sample) {
    sample.gyro_rads = stuck.gyro_rads;
    sample.accel_mps2 = stuck.accel_mps2;
  });
  EXPECT_NEAR(needed, config_.frozen_s, 0.006);
  EXPECT_EQ(last_, ImuFault::kFrozen);
  EXPECT_EQ(sanity_.faulty_since(), stuck.time) << "the last true sample";
  EXPECT_TRUE(sanity_.is_suspect());
}

TEST_F(Sanity, AGyroStuckAloneIsFoundLater) {
  run_good(1.0);
  const ImuSample stuck = good_;
  const double needed = time_to_fault([&](ImuSample& sample) { sample.gyro_rads = stuck.gyro_rads; });
  EXPECT_NEAR(needed, config_.frozen_part_s, 0.006);
  EXPECT_EQ(last_, ImuFault::kFrozen);
  EXPECT_EQ(sanity_.faulty_since(), stuck.time);
}

TEST_F(Sanity, AFewRepeatedSamplesAreNoFault) {
  for (int i = 0; i < 1'000; ++i) {
    const ImuSample first = next();
    ASSERT_EQ(sanity_.look(first), ImuFault::kNone);
    for (int repeats = 0; repeats < 3; ++repeats) {
      ImuSample again = next();
      again.gyro_rads = first.gyro_rads;
      again.accel_mps2 = first.accel_mps2;
      ASSERT_EQ(sanity_.look(again), ImuFault::kNone);
    }
  }
}

TEST_F(Sanity, TwoEqualSamplesAroundAGapAreNoFault) {
  run_good(1.0);
  now_ += std::chrono::seconds{2};
  ImuSample same = next();
  same.gyro_rads = good_.gyro_rads;
  same.accel_mps2 = good_.accel_mps2;
  EXPECT_EQ(sanity_.look(same), ImuFault::kNone);
}

TEST_F(Sanity, WhatNoVehicleFeelsForLongIsAFault) {
  const auto weightless = [](ImuSample& sample) { sample.accel_mps2.z() -= 9.8; };
  const auto crushed = [](ImuSample& sample) { sample.accel_mps2.x() += 80.0; };
  const auto top = [](ImuSample& sample) { sample.gyro_rads.z() += 9.0; };
  for (const auto& change : std::initializer_list<std::function<void(ImuSample&)>>{weightless, crushed, top}) {
    sanity_.clear();
    run_good(1.0);
    ImuSample first = next();
    change(first);
    EXPECT_EQ(sanity_.look(first), ImuFault::kImplausible);
    EXPECT_TRUE(sanity_.is_sane()) << "one sample condemns nobody";
    EXPECT_NEAR(0.005 + time_to_fault(change), config_.implausible_s, 0.011);
    EXPECT_EQ(last_, ImuFault::kImplausible);
    EXPECT_EQ(sanity_.faulty_since(), good_.time);
  }
}

TEST_F(Sanity, AfterAShortBlowTheNextGoodSampleIsUsed) {
  run_good(1.0);
  const auto blow = [](ImuSample& sample) { sample.accel_mps2.z() += 70.0; };
  EXPECT_EQ(time_to_fault(blow, 0.1), 0.1);
  EXPECT_EQ(sanity_.look(next()), ImuFault::kNone);
}

TEST_F(Sanity, ABrokenSensorIsBelievedAgainAfterGoodSamplesHaveLasted) {
  run_good(0.5);
  time_to_fault([&](ImuSample& sample) { sample.gyro_rads = sample.accel_mps2 = Eigen::Vector3d::Zero(); });
  ASSERT_FALSE(sanity_.is_sane());
  run_good(config_.sane_again_s - 0.02);
  EXPECT_FALSE(sanity_.is_sane());
  EXPECT_EQ(last_, ImuFault::kFrozen) << "on probation its samples are not used";
  run_good(0.04);
  EXPECT_TRUE(sanity_.is_sane());
  EXPECT_EQ(last_, ImuFault::kNone);
}

}  // namespace
}  // namespace slamd
