#include "drivers/io/clock_sync.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/drivers/arrival_model.hpp"

namespace slamd {
namespace {

using namespace std::chrono_literals;
using test::ArrivalModel;
using test::Jitter;

constexpr int kSettled = 400;  // samples of 200 Hz: 2 s

ClockSync::Config imu_config() {
  ClockSync::Config config;
  config.min_latency = 300us;
  config.envelope.expected_jitter_s = 1.5e-3;
  return config;
}

double error_us(HostTime estimate, HostTime truth) {
  return static_cast<double>((estimate - truth).count()) * 1e-3;
}

struct Outcome {
  double rms_settled_us = 0.0;
  double max_settled_us = 0.0;
  double rms_first_us = 0.0;  // samples 10..50
  double max_locked_step_us = 0.0;
  double z2 = 0.0;  // mean of (error / sigma)^2 after 20 samples
  bool monotone = true;
  bool locked = false;
  std::uint32_t jumps = 0;
};

Outcome run(ArrivalModel& model, ClockSync& sync, int samples) {
  Outcome r;
  double previous_us = 0.0, sum_settled = 0.0, sum_first = 0.0, sum_z2 = 0.0;
  HostTime previous{};
  for (int i = 0; i < samples; ++i) {
    const bool was_locked = sync.locked();
    const ArrivalModel::Datum datum = model.next();
    const HostTime time = sync.update(datum.device, datum.arrival);
    const double error = error_us(time, datum.truth);
    if (i > 0) r.monotone = r.monotone && time > previous;
    if (was_locked) r.max_locked_step_us = std::max(r.max_locked_step_us, std::abs(error - previous_us));
    if (i >= 10 && i < 50) sum_first += error * error;
    if (i >= 20) sum_z2 += std::pow(error * 1e3 / static_cast<double>(sync.sigma().count()), 2);
    if (i >= kSettled) {
      sum_settled += error * error;
      r.max_settled_us = std::max(r.max_settled_us, std::abs(error));
    }
    previous = time;
    previous_us = error;
  }
  r.rms_first_us = std::sqrt(sum_first / 40);
  r.rms_settled_us = std::sqrt(sum_settled / std::max(1, samples - kSettled));
  r.z2 = sum_z2 / (samples - 20);
  r.locked = sync.locked();
  r.jumps = sync.jumps();
  return r;
}

struct Case {
  const char* name;
  Jitter jitter;
  double skew_ppm;
  double drift_ppm_s;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class ClockSyncOverJitter : public testing::TestWithParam<Case> {};

TEST_P(ClockSyncOverJitter, IsWithin60MicrosecondsAfterTwoSecondsAndHonestAboutItsSigma) {
  const Case& c = GetParam();
  double mean_z2 = 0.0;
  constexpr int kSeeds = 20;
  for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
    ArrivalModel model{c.jitter, seed};
    model.skew_ppm = c.skew_ppm;
    model.skew_drift_ppm_s = c.drift_ppm_s;
    ClockSync sync{imu_config()};
    const Outcome r = run(model, sync, 6000);
    EXPECT_TRUE(r.locked) << seed;
    EXPECT_TRUE(r.monotone) << seed;
    EXPECT_EQ(r.jumps, 0U) << seed;
    EXPECT_LT(r.max_settled_us, 60.0) << seed;
    EXPECT_LT(r.rms_settled_us, 15.0) << seed;
    EXPECT_LT(r.rms_first_us, 350.0) << seed;  // a fifth of the jitter, from the tenth sample on
    EXPECT_LE(r.max_locked_step_us, 20.0) << seed;
    EXPECT_NEAR(sync.skew_ppm(), c.skew_ppm + c.drift_ppm_s * 30.0, 2.0 + 6.0 * c.drift_ppm_s) << seed;
    mean_z2 += r.z2 / kSeeds;
  }
  EXPECT_LT(mean_z2, 4.0);
}

INSTANTIATE_TEST_SUITE_P(Jitters, ClockSyncOverJitter,
                         testing::Values(Case{"uniform", Jitter::kUniform, 0.0, 0.0},
                                         Case{"uniform_slow_device", Jitter::kUniform, 200.0, 0.0},
                                         Case{"uniform_fast_device", Jitter::kUniform, -200.0, 0.0},
                                         Case{"exponential", Jitter::kExponential, 200.0, 0.0},
                                         Case{"exponential_fast_device", Jitter::kExponential, -200.0, 0.0},
                                         Case{"heavy_tail", Jitter::kHeavyTail, -200.0, 0.0},
                                         Case{"bursts", Jitter::kBursts, 200.0, 0.0},
                                         Case{"warming_up", Jitter::kUniform, 20.0, 0.5}),
                         [](const auto& tested) { return std::string{tested.param.name}; });

TEST(ClockSync, CorrectsTheMeanOfTheJitterFromTheFirstSample) {
  double sum_us = 0.0;
  constexpr int kSeeds = 400;
  for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
    ArrivalModel model{Jitter::kUniform, seed};
    ClockSync sync{imu_config()};
    const ArrivalModel::Datum datum = model.next();
    sum_us += error_us(sync.update(datum.device, datum.arrival), datum.truth);
  }
  EXPECT_NEAR(sum_us / kSeeds, 0.0, 200.0);
}

TEST(ClockSync, SurvivesAGapOfTenSeconds) {
  ArrivalModel model{Jitter::kUniform, 3};
  model.skew_ppm = 150.0;
  ClockSync sync{imu_config()};
  run(model, sync, 4000);
  model.skip(2000);
  const Outcome r = run(model, sync, 2000);
  EXPECT_EQ(r.jumps, 0U);
  EXPECT_LT(r.rms_first_us, 60.0);
  EXPECT_LT(r.max_settled_us, 60.0);
}

TEST(ClockSync, AStallOfTheReaderIsNoJump) {
  ArrivalModel model{Jitter::kUniform, 4};
  ClockSync sync{imu_config()};
  run(model, sync, 2000);
  double worst_us = 0.0;
  for (int i = 0; i < 400; ++i) {
    model.extra_delay_s = i < 100 ? 0.5 - i * 0.005 : 0.0;  // half a second of data arrives at once
    const ArrivalModel::Datum datum = model.next();
    worst_us = std::max(worst_us, std::abs(error_us(sync.update(datum.device, datum.arrival), datum.truth)));
  }
  EXPECT_EQ(sync.jumps(), 0U);
  EXPECT_TRUE(sync.locked());
  EXPECT_LT(worst_us, 60.0);
}

/// Runs into a jump and over it; returns the samples until the error is below 300 us for good.
int samples_to_recover(ClockSync& sync, ArrivalModel& model, bool& went_unsure) {
  int last_bad = -1;
  for (int i = 0; i < 1000; ++i) {
    const ArrivalModel::Datum datum = model.next();
    if (std::abs(error_us(sync.update(datum.device, datum.arrival), datum.truth)) > 300.0) last_bad = i;
    went_unsure = went_unsure || !sync.locked();
  }
  return last_bad + 1;
}

struct Jump {
  const char* name;
  double device_s, host_s;
  int at_most_samples;
};
void PrintTo(const Jump& j, std::ostream* out) {
  *out << j.name;
}

class ClockSyncOverJumps : public testing::TestWithParam<Jump> {};

TEST_P(ClockSyncOverJumps, AreCountedFlaggedAndLockedAgain) {
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    ArrivalModel model{Jitter::kUniform, seed};
    model.skew_ppm = -120.0;
    ClockSync sync{imu_config()};
    run(model, sync, 2000);
    ASSERT_TRUE(sync.locked());
    model.device_step_s = GetParam().device_s;
    model.host_step_s = GetParam().host_s;
    bool went_unsure = false;
    const int samples = samples_to_recover(sync, model, went_unsure);
    EXPECT_LE(samples, GetParam().at_most_samples) << seed;
    EXPECT_TRUE(went_unsure) << seed;
    EXPECT_EQ(sync.jumps(), 1U) << seed;
    EXPECT_TRUE(sync.locked()) << seed;
    EXPECT_NEAR(sync.skew_ppm(), -120.0, 10.0) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Jumps, ClockSyncOverJumps,
                         testing::Values(Jump{"device_reset", -10.005, 0.0, 40}, Jump{"device_forward", 5.0, 0.0, 40},
                                         Jump{"device_forward_20ms", 0.02, 0.0, 60},
                                         Jump{"device_back_20ms", -0.02, 0.0, 120}, Jump{"host_back", 0.0, -3.0, 40},
                                         Jump{"host_forward", 0.0, 3.0, 120}),
                         [](const auto& tested) { return std::string{tested.param.name}; });

TEST(ClockSync, ReorderedDataAreMappedAndTeachNothing) {
  ArrivalModel model{Jitter::kUniform, 7};
  ClockSync sync{imu_config()};
  run(model, sync, 1000);
  const ArrivalModel::Datum a = model.next();
  const ArrivalModel::Datum b = model.next();
  const HostTime time_b = sync.update(b.device, b.arrival);
  const HostTime time_a = sync.update(a.device, b.arrival);
  EXPECT_NEAR(static_cast<double>((time_b - time_a).count()), 5e6, 1e3);
  EXPECT_EQ(sync.jumps(), 0U);
  EXPECT_EQ(sync.to_host(b.device), time_b);
}

TEST(ClockSync, GivesTheSameBitsForTheSameInput) {
  std::vector<HostTime> first;
  for (int round = 0; round < 2; ++round) {
    ArrivalModel model{Jitter::kHeavyTail, 9};
    ClockSync sync{imu_config()};
    for (std::size_t i = 0; i < 3000; ++i) {
      const ArrivalModel::Datum datum = model.next();
      const HostTime time = sync.update(datum.device, datum.arrival);
      if (round == 0)
        first.push_back(time);
      else
        ASSERT_EQ(time, first[i]);
    }
  }
}

TEST(ClockSync, FindsALidarsFineJitterThoughItExpectsAnImus) {
  ArrivalModel model{Jitter::kExponential, 11};
  model.period_s = 1.327104e-3;
  model.width_s = 1e-4;
  model.skew_ppm = 30.0;
  ClockSync sync{imu_config()};
  const Outcome r = run(model, sync, 8000);
  EXPECT_LT(r.rms_settled_us, 3.0);
  EXPECT_LT(sync.jitter(), 200us);
}

/// Data that waited before the first read have all the arrival of that read: the oldest seem fresh, the newest late.
TEST(ClockSync, ABacklogReadAtOnceAtTheStartIsForgottenSoonAfter) {
  for (const Duration backlog : {Duration{100ms}, Duration{900ms}, Duration{2s}}) {
    ClockSync sync{imu_config()};
    constexpr Duration kPeriod = 1327us;
    constexpr Duration kOffset = 1000s;
    const HostTime read{kOffset + backlog};
    HostTime previous{};
    Duration device{};
    for (; device < backlog; device += kPeriod) {
      const HostTime time = sync.update(DeviceTime{device}, read);
      ASSERT_GT(time, previous);
      ASSERT_LT(time, read + backlog) << "after " << to_seconds(device) << " s";
      previous = time;
    }
    for (const Duration end = device + 3 * backlog; device < end; device += kPeriod) {
      const HostTime time = sync.update(DeviceTime{device}, HostTime{kOffset + device + 350us});
      ASSERT_GT(time, previous);
      previous = time;
    }
    EXPECT_LT(std::abs(to_seconds(previous - HostTime{kOffset + device - kPeriod})), 1e-3) << to_seconds(backlog);
    EXPECT_LT(sync.sigma(), 1ms);
  }
}

/// Something on the way holds every datum back for a while, and then gives all that it held at once.
TEST(ClockSync, DelayedDataThatComeInTimeAgainAreInTimeAgain) {
  for (const Duration delay : {Duration{50ms}, Duration{300ms}, Duration{900ms}}) {
    ClockSync sync{imu_config()};
    constexpr Duration kPeriod = 1327us;
    constexpr Duration kOffset = 1000s;
    HostTime time{};
    const auto arrival = [&](Duration device) {
      const HostTime in_time{kOffset + device + 350us};
      const bool held = device >= 10s && device < 14s;
      return held ? std::max(in_time, std::min(in_time + delay, HostTime{kOffset + 14s})) : in_time;
    };
    Duration device{};
    const auto error_s = [&] { return std::abs(to_seconds(time - HostTime{kOffset + device - kPeriod})); };
    for (; device < 17s; device += kPeriod) {
      time = sync.update(DeviceTime{device}, arrival(device));
      const double error_now_s = std::abs(to_seconds(time - HostTime{kOffset + device}));
      ASSERT_TRUE(device < 5s || error_now_s < 1e-3) << to_seconds(delay) << " at " << to_seconds(device);
    }
    EXPECT_EQ(sync.jumps(), 0U) << to_seconds(delay);
    for (; device < 24s; device += kPeriod) time = sync.update(DeviceTime{device}, arrival(device));
    EXPECT_LT(error_s(), 1e-4) << to_seconds(delay);
    EXPECT_LT(std::abs(sync.skew_ppm()), 1.0) << to_seconds(delay);
    EXPECT_TRUE(sync.locked()) << to_seconds(delay);
  }
}

TEST(ClockSync, DataThatStayDelayedAreFollowedInTheEnd) {
  ClockSync sync{imu_config()};
  constexpr Duration kPeriod = 5ms;
  constexpr Duration kDelay = 300ms;
  HostTime time{};
  Duration device{};
  const auto late_s = [&] { return to_seconds(time - HostTime{1000s + device - kPeriod}); };
  const auto run_to = [&](Duration end) {
    for (; device < end; device += kPeriod) {
      time = sync.update(DeviceTime{device}, HostTime{1000s + device + 350us + (device < 5s ? Duration{0} : kDelay)});
    }
  };
  run_to(14s);
  EXPECT_LT(std::abs(late_s()), 1e-3) << "still taken for held back";
  EXPECT_EQ(sync.jumps(), 0U);
  run_to(20s);
  EXPECT_NEAR(late_s(), to_seconds(kDelay), 1e-3) << "taken for a step of the clock";
  EXPECT_EQ(sync.jumps(), 1U);
  EXPECT_TRUE(sync.locked());
}

TEST(CounterUnwrapper, CountsOnPastTheHour) {
  CounterUnwrapper hour{3600s};
  HostTime arrival{100s};
  EXPECT_EQ(to_ns(hour.unwrap(3599s, arrival)), to_ns(DeviceTime{3599s}));
  EXPECT_EQ(to_ns(hour.unwrap(1s, arrival += 2s)), to_ns(DeviceTime{3601s}));
  EXPECT_EQ(to_ns(hour.unwrap(0s, arrival += 3599s)), to_ns(DeviceTime{7200s}));
}

TEST(CounterUnwrapper, AReorderedStampBeforeTheWrapStaysBefore) {
  CounterUnwrapper hour{3600s};
  HostTime arrival{0s};
  hour.unwrap(3599'999ms, arrival);
  EXPECT_EQ(hour.unwrap(1ms, arrival += 2ms).time_since_epoch(), 3600'001ms);
  EXPECT_EQ(hour.unwrap(3599'998ms, arrival += 1ms).time_since_epoch(), 3599'998ms);
}

TEST(CounterUnwrapper, AGapOfSeveralPeriodsIsCountedByTheHost) {
  CounterUnwrapper hour{3600s};
  hour.unwrap(10s, HostTime{0s});
  EXPECT_EQ(hour.unwrap(20s, HostTime{std::chrono::seconds{3 * 3600 + 10}}).time_since_epoch(), 3 * 3600s + 20s);
}

}  // namespace
}  // namespace slamd
