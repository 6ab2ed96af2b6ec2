#include "drivers/wheel/wheel_parser.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace slamd {
namespace {

using std::chrono::milliseconds;

constexpr HostTime kStart{std::chrono::seconds{1'000}};

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

struct WheelRun {
  WheelParser parser;
  std::vector<WheelOdometry> found;

  void feed(std::string_view text, HostTime arrival) {
    parser.feed(bytes_of(text), arrival, [this](const WheelOdometry& odometry) { found.push_back(odometry); });
  }
  /// A reading `at_ms` after the start, which arrives 2 ms later.
  void feed(int at_ms, double x_m, double y_m, double yaw_rad, std::uint32_t counter_began_us = 0) {
    const auto stamp = counter_began_us + static_cast<std::uint32_t>(at_ms) * 1'000U;
    feed(wheel_line({stamp, x_m, y_m, yaw_rad}), kStart + milliseconds{at_ms + 2});
  }
};

TEST(WheelReading, IsReadFromALineWrittenByHand) {
  WheelRun run;
  run.feed("$WODO,1500000,1.2500,-0.5000,0.100000*16\r\n", kStart);
  ASSERT_EQ(run.found.size(), 1U);
  EXPECT_DOUBLE_EQ(run.found[0].x_m, 1.25);
  EXPECT_DOUBLE_EQ(run.found[0].y_m, -0.5);
  EXPECT_DOUBLE_EQ(run.found[0].yaw_rad, 0.1);
  EXPECT_EQ(run.found[0].arrival, kStart);
}

TEST(WheelReading, RefusesTextThatIsNotExactlyTheSentence) {
  EXPECT_TRUE(parse_wheel_text("WODO,4294967295,0,0,0"));
  for (const char* text : {"", "WODO", "WODO,1,2,3", "WODO,1,2,3,4,5", "WODO,1,2,3,4,", "WODO,-1,2,3,4", "WODO,4294967296,2,3,4",
                           "WODO,1.5,2,3,4", "WODO,1,nan,3,4", "WODO,1,2,inf,4", "WODO,1,2,3,1e9", "WODO,1,1e8,3,4",
                           "WODO,1,,3,4", "WODO,1,2 ,3,4", "WODO,1,2x,3,4", "XODO,1,2,3,4", "WODO,1,2,+3,4"}) {
    EXPECT_FALSE(parse_wheel_text(text)) << text;
  }
}

TEST(WheelReading, ComesBackFromItsLine) {
  std::mt19937 random{7};
  std::uniform_real_distribution<double> number{-1e6, 1e6};
  for (int i = 0; i < 1'000; ++i) {
    const WheelReading sent{static_cast<std::uint32_t>(random()), number(random), number(random), number(random) * 1e-3};
    WheelParser parser;
    std::optional<WheelReading> found;
    for (const char c : wheel_line(sent)) {
      if (const auto reading = parser.take(static_cast<std::uint8_t>(c))) found = reading;
    }
    ASSERT_TRUE(found);
    EXPECT_EQ(found->device_us, sent.device_us);
    EXPECT_NEAR(found->x_m, sent.x_m, 5.1e-5);
    EXPECT_NEAR(found->y_m, sent.y_m, 5.1e-5);
    EXPECT_NEAR(found->yaw_rad, sent.yaw_rad, 5.1e-7);
  }
}

TEST(WheelParser, CountsWhatItRefusesByCause) {
  WheelRun run;
  run.feed("$GPGGA,x*02\r\n$WODO,1,2*10\r\n$WODO,1500000,1.2500,-0.5000,0.100000*00\r\n", kStart);
  EXPECT_TRUE(run.found.empty());
  EXPECT_EQ(run.parser.stats().other, 1U);
  EXPECT_EQ(run.parser.stats().malformed, 1U);
  EXPECT_EQ(run.parser.line_stats().bad_checksum, 1U);
}

TEST(WheelTrack, GivesTheTimeOfMeasurementAcrossTheWrapOfTheCounter) {
  WheelRun run;
  const std::uint32_t began = 0xFFFFFFFFU - 20'000'000U;  // wraps after 20 s
  std::mt19937 random{3};
  std::exponential_distribution<double> late_ms{1.0};
  for (int i = 0; i < 2'000; ++i) {
    const auto arrival = kStart + milliseconds{20 * i + 1} + from_seconds(late_ms(random) * 1e-3);
    run.feed(wheel_line({began + static_cast<std::uint32_t>(i) * 20'000U, 0.01 * i, 0.0, 0.0}), arrival);
  }
  ASSERT_EQ(run.found.size(), 2'000U);
  EXPECT_EQ(run.parser.clock().jumps(), 0U);
  for (std::size_t i = 500; i < run.found.size(); ++i) {
    const HostTime truth = kStart + milliseconds{20 * static_cast<int>(i)};
    EXPECT_LT(std::abs(to_seconds(run.found[i].time - truth)), 1e-4) << i;
  }
}

TEST(WheelTrack, GoesOnFromWhereItWasWhenTheBoardRestarts) {
  WheelRun run;
  for (int i = 0; i <= 100; ++i) run.feed(20 * i, 0.01 * i, 0.0, 0.5);
  const std::uint32_t again = 0U - 2'500'000U;  // the counter is at zero 2.5 s after the start
  for (int i = 125; i <= 200; ++i) run.feed(20 * i, 0.01 * (i - 125), 0.0, 0.0, again);
  EXPECT_EQ(run.parser.track_stats().restarts, 1U);
  EXPECT_EQ(run.parser.track_stats().rejections[WheelRejection::kDoubtful], 1U);
  const WheelOdometry& last = run.found.back();
  EXPECT_NEAR(last.x_m, 1.0 + 0.75 * std::cos(0.5), 1e-6);
  EXPECT_NEAR(last.y_m, 0.75 * std::sin(0.5), 1e-6);
  EXPECT_NEAR(last.yaw_rad, 0.5, 1e-9);
  for (std::size_t i = 1; i < run.found.size(); ++i) {
    EXPECT_LT(std::hypot(run.found[i].x_m - run.found[i - 1].x_m, run.found[i].y_m - run.found[i - 1].y_m), 0.011);
    EXPECT_GT(run.found[i].time, run.found[i - 1].time);
  }
}

TEST(WheelTrack, LeavesOutOneReadingThatCannotBe) {
  WheelRun run;
  for (int i = 0; i <= 50; ++i) run.feed(20 * i, 0.01 * i, 0.0, 0.0);
  run.feed(20 * 51, 400.0, 0.0, 0.0);
  run.feed(20 * 51, 400.0, 0.0, 0.0);
  run.feed(20 * 52, 0.52, 0.0, 0.0);
  EXPECT_EQ(run.parser.track_stats().restarts, 0U);
  EXPECT_EQ(run.parser.track_stats().rejections[WheelRejection::kDoubtful], 2U);
  EXPECT_NEAR(run.found.back().x_m, 0.52, 1e-9);
  run.feed(20 * 52, 0.52, 0.0, 0.0);
  EXPECT_EQ(run.parser.track_stats().rejections[WheelRejection::kRepeated], 1U);
}

TEST(WheelTrack, GivesAContinuousYawAlsoWhereTheBoardWrapsIt) {
  WheelRun run;
  for (int i = 0; i < 400; ++i) run.feed(20 * i, 0.0, 0.0, std::remainder(0.05 * i, 2.0 * M_PI));
  ASSERT_EQ(run.found.size(), 400U);
  EXPECT_NEAR(run.found.back().yaw_rad, 0.05 * 399, 1e-4);
}

}  // namespace
}  // namespace slamd
