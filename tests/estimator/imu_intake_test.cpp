#include "estimator/odometry/imu_intake.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds{5};

HostTime ms(std::int64_t milliseconds) { return from_ns<HostTime>(milliseconds * 1'000'000); }

class Intake : public ::testing::Test {
 protected:
  ImuSample sample_at(HostTime time) {
    ImuSample sample{.time = time, .arrival = time + std::chrono::microseconds{300}};
    sample.gyro_rads = test::normal3(random_, 0.002);
    sample.accel_mps2 = Eigen::Vector3d{0.0, 0.0, 9.8} + test::normal3(random_, 0.02);
    return sample;
  }
  void run(HostTime from, HostTime to) {
    for (HostTime t = from; t < to; t += kPeriod) ASSERT_TRUE(intake_.add(sample_at(t)));
  }

  ImuIntake intake_{ImuIntakeConfig{}};
  test::Random random_{3};
};

TEST_F(Intake, AnImuThatFallsSilentIsAliveUntilItsTimeout) {
  EXPECT_FALSE(intake_.is_alive(ms(0)));
  run(ms(1'000), ms(2'000));
  EXPECT_TRUE(intake_.is_alive(ms(2'200)));
  EXPECT_FALSE(intake_.is_alive(ms(2'246)));
  EXPECT_TRUE(intake_.covers(ms(1'995)));
  EXPECT_FALSE(intake_.covers(ms(1'996)));
}

TEST_F(Intake, ValuesThatAreNotFiniteAreCountedAndNotTaken) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    ImuSample gyro = sample_at(ms(20)), accel = sample_at(ms(20));
    gyro.gyro_rads.y() = bad;
    accel.accel_mps2.z() = bad;
    EXPECT_FALSE(intake_.add(gyro));
    EXPECT_FALSE(intake_.add(accel));
  }
  EXPECT_TRUE(intake_.samples().empty());
  EXPECT_EQ(intake_.stats().not_finite, 4U);
}

TEST_F(Intake, AStampFarInTheFutureBlocksNobody) {
  run(ms(1'000), ms(1'500));
  ImuSample future = sample_at(ms(100'000));
  future.arrival = ms(1'500);
  EXPECT_FALSE(intake_.add(future));
  EXPECT_EQ(intake_.stats().in_future, 1U);
  EXPECT_TRUE(intake_.is_clock_unsure(ms(1'600)));
  run(ms(1'505), ms(4'000));
  EXPECT_FALSE(intake_.is_clock_unsure(ms(3'000)));
  EXPECT_EQ(intake_.stats().out_of_order, 0U);
}

TEST_F(Intake, AfterAClockHasSteppedBackTheNewStampsCount) {
  run(ms(10'000), ms(11'000));
  HostTime t = ms(7'000);
  std::uint32_t refused = 0;
  for (; refused < 100; t += kPeriod, ++refused) {
    ImuSample sample = sample_at(t);
    sample.arrival += std::chrono::seconds{4};
    if (intake_.add(sample)) break;
  }
  EXPECT_EQ(refused, ImuIntake::kBackwardSamples - 1);
  EXPECT_EQ(intake_.stats().out_of_order, refused);
  EXPECT_EQ(intake_.stats().clock_restarts, 1U);
  EXPECT_EQ(intake_.samples().size(), 1U);
  EXPECT_EQ(intake_.samples().newest().time, t);
  EXPECT_TRUE(intake_.is_clock_unsure(ms(11'200)));
}

TEST_F(Intake, OldSamplesBetweenNewOnesNeverRestartTheClock) {
  for (HostTime t = ms(1'000); t < ms(3'000); t += kPeriod) {
    ASSERT_TRUE(intake_.add(sample_at(t)));
    ASSERT_FALSE(intake_.add(sample_at(t - std::chrono::milliseconds{50})));
  }
  EXPECT_EQ(intake_.stats().clock_restarts, 0U);
  EXPECT_EQ(intake_.stats().out_of_order, 400U);
}

TEST_F(Intake, TheSamplesOfAStuckSensorAreTakenBack) {
  run(ms(1'000), ms(2'000));
  const ImuSample last = intake_.samples().newest();
  ImuSample stuck = last;
  for (int i = 0; i < 100; ++i) {
    stuck.time += kPeriod;
    stuck.arrival += kPeriod;
    intake_.add(stuck);
  }
  EXPECT_FALSE(intake_.is_alive(stuck.time));
  EXPECT_EQ(intake_.samples().newest().time, last.time);
  EXPECT_EQ(intake_.stats().frozen, 100U - 9U) << "those before the fault was sure are not counted";
  for (HostTime t = stuck.time + kPeriod; t < stuck.time + std::chrono::seconds{1}; t += kPeriod) intake_.add(sample_at(t));
  EXPECT_TRUE(intake_.is_alive(stuck.time + std::chrono::seconds{1}));
}

}  // namespace
}  // namespace slamd
