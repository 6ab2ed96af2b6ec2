#include "drivers/io/sample_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <vector>

namespace slamd {
namespace {

using namespace std::chrono_literals;

struct Sample {
  HostTime truth, arrival;
};

/// Equally spaced samples with uniform jitter; those at `lost` never arrive.
std::vector<Sample> stream(double rate_hz, int count, std::uint32_t seed, double lost_share = 0.0) {
  std::mt19937 random{seed};
  std::uniform_real_distribution<double> uniform{0.0, 1.0};
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    const double t = i / rate_hz;
    const double arrival = t + 3e-4 + 1.7e-3 * uniform(random);
    if (i > 0 && uniform(random) < lost_share) continue;
    const HostTime epoch{1'780'300'800s};
    samples.push_back({epoch + from_seconds(t), epoch + from_seconds(arrival)});
  }
  return samples;
}

/// Largest error from sample `from` on.
double worst_us(SampleClock& clock, const std::vector<Sample>& samples, std::size_t from) {
  double worst = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto next = i + 1 < samples.size() ? std::optional{samples[i + 1].arrival} : std::nullopt;
    const HostTime time = clock.update(samples[i].arrival, next);
    if (i >= from) worst = std::max(worst, std::abs(static_cast<double>((time - samples[i].truth).count())) * 1e-3);
  }
  return worst;
}

TEST(SampleClock, FindsPhaseAndPeriodAtAnyUsualRate) {
  for (const double rate_hz : {196.0, 199.98, 200.0, 200.03, 208.0}) {
    for (std::uint32_t seed = 0; seed < 5; ++seed) {
      SampleClock clock{{}};
      const auto samples = stream(rate_hz, 3000, seed);
      EXPECT_LT(worst_us(clock, samples, 400), 60.0) << rate_hz << ' ' << seed;
      EXPECT_NEAR(1.0 / clock.period_s(), rate_hz, 2e-3) << seed;
      EXPECT_EQ(clock.missing(), 0U);
      EXPECT_EQ(clock.jumps(), 0U);
    }
  }
}

TEST(SampleClock, CountsMissingSamples) {
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    SampleClock clock{{}};
    const auto samples = stream(200.0, 4000, seed, 0.03);
    EXPECT_LT(worst_us(clock, samples, 400), 60.0) << seed;
    const double end = to_seconds(samples.back().truth - samples.front().truth);
    EXPECT_EQ(clock.missing(), static_cast<std::uint64_t>(std::llround(end * 200.0)) + 1 - samples.size());
  }
}

TEST(SampleClock, KeepsThePhaseOverAGapOfTwoSeconds) {
  SampleClock clock{{}};
  auto samples = stream(207.9, 5000, 3);
  samples.erase(samples.begin() + 2000, samples.begin() + 2416);
  EXPECT_LT(worst_us(clock, samples, 400), 60.0);
  EXPECT_EQ(clock.missing(), 416U);
  EXPECT_EQ(clock.jumps(), 0U);
}

TEST(SampleClock, SamplesThatWaitedTogetherAreNotTakenForMissingOnes) {
  SampleClock clock{{}};
  auto samples = stream(200.0, 3000, 4);
  for (std::size_t first = 1000; first < 2800; first += 300) {
    const HostTime all_at = samples[first + 9].arrival;
    for (std::size_t i = first; i < first + 9; ++i) samples[i].arrival = all_at;
  }
  EXPECT_LT(worst_us(clock, samples, 400), 60.0);
  EXPECT_EQ(clock.missing(), 0U);
}

TEST(SampleClock, WithoutAForesightALateBurstIsMadeUpFor) {
  SampleClock clock{{}};
  auto samples = stream(200.0, 2000, 5);
  for (std::size_t i = 1000; i < 1005; ++i) samples[i].arrival = samples[1005].arrival;
  for (const Sample& sample : samples) clock.update(sample.arrival);
  EXPECT_NEAR(static_cast<double>((clock.time_of(clock.index()) - samples.back().truth).count()) * 1e-3, 0.0, 60.0);
}

TEST(SampleClock, TimesNeverGoBack) {
  SampleClock clock{{}};
  HostTime previous{};
  for (const Sample& sample : stream(208.0, 2000, 6, 0.1)) {
    const HostTime time = clock.update(sample.arrival);
    EXPECT_GE(time, previous);
    previous = time;
  }
}

}  // namespace
}  // namespace slamd
