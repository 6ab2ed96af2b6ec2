#include "daemon/health/histogram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace slamd {
namespace {

TEST(Histogram, IsZeroWhenNothingWasRecorded) {
  const Percentiles percentiles = Histogram{}.percentiles();
  EXPECT_EQ(percentiles.count, 0U);
  EXPECT_EQ(percentiles.p999, Duration{0});
}

TEST(Histogram, PercentilesAreWithinTheWidthOfABucketAtAnyScale) {
  std::mt19937_64 random{7};
  std::uniform_real_distribution<double> exponent{0.0, std::log(60e9)};
  Histogram histogram;
  std::vector<std::int64_t> values;
  for (int i = 0; i < 20'000; ++i) {
    values.push_back(static_cast<std::int64_t>(std::exp(exponent(random))));
    histogram.record(Duration{values.back()});
  }
  std::sort(values.begin(), values.end());
  const Percentiles percentiles = histogram.percentiles();
  const auto expect_near = [&](Duration got, double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size()))) - 1;
    EXPECT_NEAR(static_cast<double>(got.count()), static_cast<double>(values[rank]),
                0.017 * static_cast<double>(values[rank]) + 1.0);
  };
  expect_near(percentiles.p50, 0.5);
  expect_near(percentiles.p90, 0.9);
  expect_near(percentiles.p99, 0.99);
  expect_near(percentiles.p999, 0.999);
  EXPECT_EQ(percentiles.max.count(), values.back());
  EXPECT_EQ(percentiles.count, values.size());
}

TEST(Histogram, CountsUpToLimitsAreThoseOfTheValuesButForTheWidthOfABucket) {
  using std::chrono::microseconds;
  Histogram histogram;
  for (int i = 1; i <= 1000; ++i) histogram.record(microseconds{i});
  const std::vector<Duration> limits{microseconds{10}, microseconds{100}, microseconds{500}, std::chrono::seconds{10}};
  const std::vector<std::uint64_t> counts = histogram.counts_up_to(limits);
  ASSERT_EQ(counts.size(), limits.size());
  EXPECT_EQ(counts[0], 10U);
  EXPECT_NEAR(static_cast<double>(counts[1]), 100.0, 3.0);
  EXPECT_NEAR(static_cast<double>(counts[2]), 500.0, 15.0);
  EXPECT_EQ(counts[3], 1000U);
  EXPECT_EQ(histogram.sum(), microseconds{500'500});
}

TEST(Histogram, NegativeAndEndlessDurationsAreCountedAtTheEnds) {
  Histogram histogram;
  histogram.record(Duration{-5});
  EXPECT_EQ(histogram.percentiles().p50, Duration{0});
  histogram.record(Duration::max());
  histogram.record(Duration::max());
  EXPECT_EQ(histogram.percentiles().count, 3U);
  EXPECT_EQ(histogram.percentiles().max, Duration::max());
  EXPECT_GT(histogram.percentiles().p99, std::chrono::seconds{60});
}

}  // namespace
}  // namespace slamd
