// Arithmetic and limits of the sensor's self-test.

#include "firmware/core/self_test.hpp"

#include <gtest/gtest.h>

namespace slamd {
namespace {

using Axes = std::array<std::int16_t, 3>;

SelfTestReport run(const Axes& accel_change, const Axes& gyro_change, std::int16_t offset = 0) {
  SelfTest test;
  for (int i = 0; i < 2 * SelfTest::kSamples; ++i) {
    const bool forced = i >= SelfTest::kSamples;
    RawSample sample;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sample.accel[axis] = static_cast<std::int16_t>(offset + (forced ? accel_change[axis] : 0));
      sample.gyro[axis] = static_cast<std::int16_t>(offset + (forced ? gyro_change[axis] : 0));
    }
    const auto expected = i == SelfTest::kSamples - 1       ? SelfTest::Progress::kHalf
                          : i == 2 * SelfTest::kSamples - 1 ? SelfTest::Progress::kComplete
                                                            : SelfTest::Progress::kMore;
    EXPECT_EQ(test.add(sample), expected) << i;
  }
  return test.report();
}

TEST(SelfTest, ChangesAreGivenInMgAndTenthsOfDps) {
  const SelfTestReport report = run({1000, -1000, 8000}, {3000, -3000, 9000}, 200);
  EXPECT_EQ(report.outcome, SelfTestOutcome::kPassed);
  EXPECT_EQ(report.accel_mg, (Axes{122, -122, 976}));
  EXPECT_EQ(report.gyro_ddps, (Axes{2100, -2100, 6300}));
}

TEST(SelfTest, EveryAxisIsHeldToTheLimitsOfTheDataSheet) {
  // 50..1700 mg are 410..13934 counts, 150..700 dps are 2143..10000 counts.
  EXPECT_EQ(run({410, 13'934, 1000}, {2143, 10'000, 3000}).failed_axes, 0);
  EXPECT_EQ(run({409, 1000, 1000}, {3000, 3000, 3000}).failed_axes, 0x01);
  EXPECT_EQ(run({1000, 13'951, 1000}, {3000, 3000, 3000}).failed_axes, 0x02);
  EXPECT_EQ(run({1000, 1000, 0}, {3000, 3000, 3000}).failed_axes, 0x04);
  EXPECT_EQ(run({1000, 1000, 1000}, {2142, 3000, 3000}).failed_axes, 0x08);
  EXPECT_EQ(run({1000, 1000, 1000}, {3000, 10'002, 3000}).failed_axes, 0x10);
  EXPECT_EQ(run({1000, 1000, 1000}, {3000, 3000, 0}).failed_axes, 0x20);
}

TEST(SelfTest, AChangeFromEndToEndDoesNotWrapIntoPassing) {
  SelfTest test;
  RawSample low, high;
  low.accel = low.gyro = {-32768, -32768, -32768};
  high.accel = high.gyro = {32767, 32767, 32767};
  for (int i = 0; i < SelfTest::kSamples; ++i) test.add(low);
  for (int i = 0; i < SelfTest::kSamples; ++i) test.add(high);
  EXPECT_EQ(test.report().failed_axes, 0x3F);
}

}  // namespace
}  // namespace slamd
