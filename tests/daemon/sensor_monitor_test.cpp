#include "daemon/health/sensor_monitor.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace slamd {
namespace {

using Use = SensorEvidence::Use;

constexpr SensorPatience kPatience{.late_s = 0.2, .least_rate_hz = 100, .most_bad_share = 0.05, .faulty_s = 1.0,
                                   .clean_s = 3.0, .proving_s = 1.0};

HostTime at(double seconds) {
  return HostTime{from_seconds(100.0 + seconds)};
}

/// A sensor of 200 items a second, looked at ten times a second.
class Sensor {
 public:
  void pass(double seconds) {
    for (const double end = now_s_ + seconds; now_s_ < end - 0.05;) look();
  }
  /// Until the state is `state`, a minute at most; seconds it took.
  double pass_until(SensorState state) {
    const double begin = now_s_;
    while (condition.state != state && now_s_ < begin + 60.0) look();
    EXPECT_EQ(condition.state, state);
    return now_s_ - begin;
  }
  std::string told() const { return std::string{name(condition.state)} + " " + name(condition.defect); }

  SensorEvidence evidence{.present = true};
  double rate_hz = 200.0;
  double bad_hz = 0.0;
  bool sends = true;
  bool good = true;
  SensorCondition condition;

 private:
  void look() {
    now_s_ += 0.1;
    if (sends && evidence.present) {
      evidence.heard = at(now_s_);
      if (good) evidence.good_at = at(now_s_);
      evidence.good += good ? static_cast<std::uint64_t>(rate_hz / 10.0) : 0;
      evidence.bad += static_cast<std::uint64_t>((good ? bad_hz : rate_hz) / 10.0);
    }
    condition = monitor_.look(evidence, at(now_s_));
  }

  SensorMonitor monitor_{kPatience};
  double now_s_ = 0.0;
};

TEST(SensorMonitor, ASensorThatIsThereStartsAndIsHealthyOnceItHasProvedItself) {
  Sensor sensor;
  sensor.pass(0.1);
  EXPECT_EQ(sensor.told(), "starting no_device");
  EXPECT_NEAR(sensor.pass_until(SensorState::kHealthy), kPatience.proving_s, 0.25);
  EXPECT_EQ(sensor.told(), "healthy none");
}

TEST(SensorMonitor, ADeviceMayTakeSecondsToWakeUp) {
  Sensor sensor;
  sensor.sends = false;
  sensor.pass(9.0);
  EXPECT_EQ(sensor.told(), "starting silent");
  sensor.pass(3.0);
  EXPECT_EQ(sensor.told(), "faulty silent");
}

TEST(SensorMonitor, WithoutADeviceItIsAbsentAndStartsAgainWithOne) {
  Sensor sensor;
  sensor.pass(3.0);
  sensor.evidence.present = false;
  sensor.pass(0.1);
  EXPECT_EQ(sensor.told(), "absent no_device");
  sensor.evidence.present = true;
  sensor.pass(0.2);
  EXPECT_EQ(sensor.condition.state, SensorState::kStarting);
  EXPECT_EQ(sensor.condition.times_faulty, 0U);
}

TEST(SensorMonitor, SilenceIsFirstDegradedThenFaultyAndHealthyOnlyAfterACleanPeriod) {
  Sensor sensor;
  sensor.pass(3.0);
  sensor.sends = false;
  EXPECT_NEAR(sensor.pass_until(SensorState::kDegraded), kPatience.late_s, 0.15);
  EXPECT_EQ(sensor.told(), "degraded silent");
  EXPECT_NEAR(sensor.pass_until(SensorState::kFaulty), kPatience.faulty_s, 0.15);
  sensor.pass(20.0);
  sensor.sends = true;
  sensor.evidence.use = Use::kRefused;  // the estimator has not heard of it yet
  sensor.pass(0.2);
  sensor.evidence.use = Use::kUsed;
  sensor.pass(1.8);
  EXPECT_EQ(sensor.told(), "faulty silent") << "what made it faulty, until it is clean";
  EXPECT_LT(sensor.pass_until(SensorState::kHealthy), kPatience.clean_s);
  EXPECT_EQ(sensor.condition.times_faulty, 1U);
}

TEST(SensorMonitor, AShortSilenceIsDegradedAndForgivenSooner) {
  Sensor sensor;
  sensor.pass(3.0);
  sensor.sends = false;
  sensor.pass(0.6);
  sensor.sends = true;
  EXPECT_EQ(sensor.condition.state, SensorState::kDegraded);
  EXPECT_LT(sensor.pass_until(SensorState::kHealthy), 2.5);
  EXPECT_EQ(sensor.condition.times_faulty, 0U);
}

TEST(SensorMonitor, ASensorThatComesAndGoesIsFaultyThoughNoSilenceWasLong) {
  Sensor sensor;
  sensor.pass(3.0);
  for (int i = 0; i < 6; ++i) {
    sensor.sends = false;
    sensor.pass(0.5);
    sensor.sends = true;
    sensor.pass(0.5);
  }
  EXPECT_EQ(sensor.condition.state, SensorState::kFaulty);
}

TEST(SensorMonitor, BytesWithoutAGoodItemAreRefusedAndSentencesWithoutAFixAreNoFault) {
  Sensor sensor;
  sensor.pass(3.0);
  sensor.good = false;
  sensor.pass(0.4);
  EXPECT_EQ(sensor.told(), "degraded refused");
  sensor.evidence.spoke = at(1000.0);
  sensor.pass(20.0);
  EXPECT_EQ(sensor.told(), "degraded no_fix");
}

TEST(SensorMonitor, WhatTheEstimatorDoesNotBelieveIsFaultyAndWhatItDoubtsIsDegraded) {
  Sensor sensor;
  sensor.pass(3.0);
  sensor.evidence.use = Use::kDoubted;
  sensor.pass(20.0);
  EXPECT_EQ(sensor.told(), "degraded doubted");
  sensor.evidence.use = Use::kRefused;
  EXPECT_NEAR(sensor.pass_until(SensorState::kFaulty), kPatience.faulty_s, 0.15);
  EXPECT_EQ(sensor.told(), "faulty unused");
  sensor.evidence.use = Use::kUsed;
  EXPECT_NEAR(sensor.pass_until(SensorState::kHealthy), kPatience.clean_s, 0.15);
}

TEST(SensorMonitor, RatesAndSharesOfASecondDegrade) {
  Sensor slow, damaged;
  slow.pass(3.0);
  damaged.pass(3.0);
  slow.rate_hz = 50.0;
  damaged.bad_hz = 30.0;
  slow.pass(3.0);
  damaged.pass(3.0);
  EXPECT_EQ(slow.told(), "degraded slow");
  EXPECT_EQ(damaged.told(), "degraded damaged");
  slow.rate_hz = 200.0;
  EXPECT_LT(slow.pass_until(SensorState::kHealthy), 3.0);
}

TEST(SensorMonitor, AnUnsureClockKeepsItFromHealthAndWhatStartsForTooLongIsDegraded) {
  Sensor sensor;
  sensor.evidence.clock_sure = false;
  sensor.pass(9.0);
  EXPECT_EQ(sensor.told(), "starting unsure_clock");
  sensor.pass(3.0);
  EXPECT_EQ(sensor.told(), "degraded unsure_clock");
}

TEST(SensorMonitor, AJudgeThatSleptAccusesNobodyOfMoreThanASecond) {
  SensorMonitor monitor{kPatience};
  SensorEvidence evidence{.present = true};
  evidence.heard = evidence.good_at = at(0.0);
  for (int i = 0; i < 20; ++i) {
    evidence.good += 20;
    evidence.heard = evidence.good_at = at(0.1 * i);
    monitor.look(evidence, at(0.1 * i));
  }
  EXPECT_EQ(monitor.look(evidence, at(60.0)).state, SensorState::kFaulty);
  SensorMonitor other{kPatience};
  for (int i = 0; i < 20; ++i) {
    evidence.good += 20;
    evidence.good_at = at(0.1 * i);
    other.look(evidence, at(0.1 * i));
  }
  evidence.good += 20 * 600;
  evidence.good_at = at(60.0);
  EXPECT_EQ(other.look(evidence, at(60.0)).state, SensorState::kHealthy);
}

}  // namespace
}  // namespace slamd
