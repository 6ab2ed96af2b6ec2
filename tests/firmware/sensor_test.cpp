// The sensor's state machine on a register model: set-up, samples, every fault and the way back.

#include "firmware/core/sensor.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/firmware/sensor_fake.hpp"

namespace slamd {
namespace {

class SensorTest : public testing::Test {
 protected:
  /// Steps every 100 us for `duration`.
  std::vector<RawSample> run(Micros duration) {
    std::vector<RawSample> samples;
    for (const Micros end = now_ + duration; now_ < end; now_ += 100) {
      if (const auto sample = sensor_.step(now_, fake_.at(now_))) samples.push_back(*sample);
      longest_pause_ = std::max(longest_pause_, now_ - std::min(now_, sensor_.last_progress()));
    }
    return samples;
  }

  test::SensorFake fake_;
  Sensor sensor_{fake_};
  Micros now_ = 0;
  Micros longest_pause_ = 0;
};

TEST_F(SensorTest, NothingIsWrittenBeforeTheSensorHasBooted) {
  run(19'000);
  EXPECT_TRUE(fake_.writes.empty());
  EXPECT_EQ(sensor_.state(), SensorState::kStarting);
}

TEST_F(SensorTest, SetsRangesRateAndDataReadyAfterAReset) {
  run(100'000);
  EXPECT_EQ(sensor_.state(), SensorState::kRunning);
  EXPECT_EQ(sensor_.id(), 0x6C);
  EXPECT_EQ(fake_.writes.front(), (std::array<std::uint8_t, 2>{0x12, 0x01}));
  EXPECT_EQ(fake_.registers[0x10], 0x58);  // 208 Hz, +-4 g
  EXPECT_EQ(fake_.registers[0x11], 0x54);  // 208 Hz, +-500 dps
  EXPECT_EQ(fake_.registers[0x12], 0x44);  // block data update, address increment
  EXPECT_EQ(fake_.registers[0x0B], 0x80);  // pulsed data-ready
  EXPECT_EQ(fake_.registers[0x0D], 0x02);  // on INT1
  EXPECT_EQ(fake_.writes.back(), (std::array<std::uint8_t, 2>{0x0D, 0x02}));
}

TEST_F(SensorTest, SamplesCarryTheStampOfTheirEdgeAndTheRightAxes) {
  fake_.gyro = {0x0102, -2, 0x0506};
  fake_.accel = {-32768, 32767, 0x0B0C};
  fake_.temperature = -256;
  const auto samples = run(1'000'000);
  EXPECT_NEAR(static_cast<double>(samples.size()), 200, 4);
  for (const RawSample& sample : samples) {
    EXPECT_EQ(sample.stamp % test::SensorFake::kPeriod, 0U);
    EXPECT_EQ(sample.gyro, fake_.gyro);
    EXPECT_EQ(sample.accel, fake_.accel);
    EXPECT_EQ(sample.temperature, -256);
    EXPECT_FALSE(sample.overrun);
  }
}

TEST_F(SensorTest, EdgesThatWereNotServedAreOverruns) {
  run(200'000);
  now_ += 5 * test::SensorFake::kPeriod;  // the loop stood still
  const auto samples = run(10'000);
  ASSERT_GE(samples.size(), 2U);
  EXPECT_TRUE(samples[0].overrun);
  EXPECT_FALSE(samples[1].overrun);
  EXPECT_GE(sensor_.counters().overruns, 4U);
  EXPECT_LE(sensor_.counters().overruns, 5U);
}

TEST_F(SensorTest, ASampleThatIsReplacedWhileItIsReadIsNotGiven) {
  run(200'000);
  fake_.data_ready_dead = true;
  fake_.edge(now_);
  EXPECT_FALSE(sensor_.step(now_, fake_.at(now_)));  // starts reading
  fake_.edge(now_ + 50);
  EXPECT_FALSE(sensor_.step(now_ + 100, fake_.at(now_)));
  EXPECT_FALSE(sensor_.step(now_ + 200, fake_.at(now_)));  // starts reading the newer one
  const auto sample = sensor_.step(now_ + 300, fake_.at(now_));
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->stamp, now_ + 50);
  EXPECT_TRUE(sample->overrun);
}

TEST_F(SensorTest, AMissingSensorIsAFaultAndIsFoundWhenItComes) {
  fake_.present = false;
  EXPECT_TRUE(run(1'000'000).empty());
  EXPECT_EQ(sensor_.state(), SensorState::kFault);
  EXPECT_EQ(sensor_.fault(), SensorFault::kNoAnswer);
  EXPECT_EQ(sensor_.counters().faults, 1U);
  EXPECT_GE(sensor_.counters().restarts, 8U);
  fake_.present = true;
  EXPECT_FALSE(run(300'000).empty());
  EXPECT_EQ(sensor_.state(), SensorState::kRunning);
}

TEST_F(SensorTest, AnotherChipAtTheAddressIsRefused) {
  fake_.registers[0x0F] = 0x6B;
  run(200'000);
  EXPECT_EQ(sensor_.state(), SensorState::kFault);
  EXPECT_EQ(sensor_.fault(), SensorFault::kWrongId);
  EXPECT_EQ(sensor_.id(), 0x6B);
  EXPECT_TRUE(fake_.writes.empty());
}

TEST_F(SensorTest, AHungBusIsGivenUpAfterMillisecondsAndRecovered) {
  run(200'000);
  fake_.hung = true;
  fake_.hung_until_clocks = 3;
  run(20'000);
  EXPECT_EQ(sensor_.state(), SensorState::kFault);
  EXPECT_EQ(sensor_.fault(), SensorFault::kBusHung);
  const auto samples = run(700'000);
  EXPECT_FALSE(samples.empty());
  EXPECT_EQ(sensor_.state(), SensorState::kRunning);
  EXPECT_EQ(sensor_.counters().recoveries, 3U);
  EXPECT_EQ(sensor_.counters().faults, 1U);
}

TEST_F(SensorTest, AResetThatDoesNotEndIsAFault) {
  fake_.reset_sticks = true;
  run(100'000);
  EXPECT_EQ(sensor_.fault(), SensorFault::kConfiguration);
}

TEST_F(SensorTest, ASettingThatDoesNotHoldIsAFault) {
  fake_.stuck_register = 0x11;
  run(100'000);
  EXPECT_EQ(sensor_.state(), SensorState::kFault);
  EXPECT_EQ(sensor_.fault(), SensorFault::kConfiguration);
}

TEST_F(SensorTest, ASensorThatLostItsPowerIsSetUpAnew) {
  run(200'000);
  fake_.power_up();  // rates off: no data-ready any more
  run(60'000);
  EXPECT_EQ(sensor_.fault(), SensorFault::kNoData);
  EXPECT_EQ(sensor_.state(), SensorState::kFault);
  EXPECT_FALSE(run(300'000).empty());
  EXPECT_EQ(sensor_.state(), SensorState::kRunning);
}

TEST_F(SensorTest, ADeadDataReadyLineStaysAFaultUntilASampleComes) {
  fake_.data_ready_dead = true;
  run(400'000);
  EXPECT_EQ(sensor_.fault(), SensorFault::kNoData);
  for (int i = 0; i < 20; ++i) {
    run(100'000);
    EXPECT_EQ(sensor_.state(), SensorState::kFault);
  }
  EXPECT_EQ(sensor_.counters().faults, 1U);
}

TEST_F(SensorTest, SelfTestPassesReportsAndReturnsToTheOldRanges) {
  run(200'000);
  fake_.self_test_accel = {1000, 2000, 3000};
  fake_.self_test_gyro = {3000, 4000, 5000};
  ASSERT_TRUE(sensor_.begin_self_test());
  EXPECT_FALSE(sensor_.begin_self_test());
  EXPECT_EQ(sensor_.state(), SensorState::kSelfTest);
  EXPECT_TRUE(run(350'000).empty()) << "samples under force are not motion";
  const auto samples = run(300'000);
  const auto report = sensor_.take_report();
  ASSERT_TRUE(report);
  EXPECT_FALSE(sensor_.take_report());
  EXPECT_EQ(report->outcome, SelfTestOutcome::kPassed);
  EXPECT_EQ(report->accel_mg, (std::array<std::int16_t, 3>{122, 244, 366}));
  EXPECT_EQ(report->gyro_ddps, (std::array<std::int16_t, 3>{2100, 2800, 3500}));
  EXPECT_FALSE(samples.empty());
  EXPECT_EQ(fake_.registers[0x11], 0x54);
  EXPECT_EQ(fake_.registers[0x14], 0x00);
  EXPECT_EQ(sensor_.counters().overruns, 0U);
}

TEST_F(SensorTest, SelfTestOfASensorWithoutForceFails) {
  run(200'000);
  fake_.self_test_accel = {};
  fake_.self_test_gyro = {};
  ASSERT_TRUE(sensor_.begin_self_test());
  run(600'000);
  const auto report = sensor_.take_report();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->outcome, SelfTestOutcome::kFailed);
  EXPECT_EQ(report->failed_axes, 0x3F);
}

TEST_F(SensorTest, ASensorLostInTheSelfTestEndsItAsNotRun) {
  run(200'000);
  ASSERT_TRUE(sensor_.begin_self_test());
  run(50'000);
  fake_.present = false;
  run(600'000);
  const auto report = sensor_.take_report();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->outcome, SelfTestOutcome::kNotRun);
  EXPECT_EQ(sensor_.state(), SensorState::kFault);
}

TEST_F(SensorTest, NoSelfTestOfASensorThatIsNotThere) {
  fake_.present = false;
  run(200'000);
  EXPECT_FALSE(sensor_.begin_self_test());
}

TEST_F(SensorTest, ProgressNeverPausesForLongWhateverTheSensorDoes) {
  run(300'000);
  fake_.data_ready_dead = true;
  run(1'000'000);
  fake_.hung = true;
  run(1'000'000);
  fake_.hung = false;
  fake_.data_ready_dead = false;
  run(1'000'000);
  sensor_.begin_self_test();
  run(1'000'000);
  EXPECT_LT(longest_pause_, 400'000U);
}

}  // namespace
}  // namespace slamd
