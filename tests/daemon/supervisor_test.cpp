#include "daemon/threads/supervisor.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "daemon/threads/source_health.hpp"
#include "estimator/types/nav_state.hpp"

namespace slamd {
namespace {

HostTime at_s(double s) {
  return HostTime{from_seconds(s)};
}

std::optional<PoseSample> pose_that_says(StatusReason reason) {
  PoseSample sample;
  sample.status = static_cast<std::uint32_t>(TrackingStatus::kDegraded);
  sample.reasons = bit(reason);
  return sample;
}

TEST(SensorEvidence, ALidarIsPresentWhileItWasHeardLately) {
  LidarReport report;
  EXPECT_FALSE(evidence(report, {}, at_s(10)).present);
  report.decoder.received = report.packets = 5;
  report.last_received = report.last_arrival = at_s(9.5);
  report.decoder.rejections.add(LidarRejection::kHdl32e, 3);
  const SensorEvidence told = evidence(report, {}, at_s(10));
  EXPECT_TRUE(told.present);
  EXPECT_EQ(told.good_at, at_s(9.5));
  EXPECT_EQ(told.bad, 3U);
  EXPECT_FALSE(evidence(report, {}, at_s(20)).present);
  EXPECT_EQ(source_health(report).rejected[0].second, 3U);
}

TEST(SensorEvidence, ThePoseSaysWhichSensorTheEstimatorDoesNotBelieve) {
  using Use = SensorEvidence::Use;
  EXPECT_EQ(evidence(ImuReport{}, pose_that_says(StatusReason::kNoImu)).use, Use::kRefused);
  GnssReport stuck;
  EXPECT_EQ(evidence(stuck, std::nullopt).use, Use::kUsed);
  stuck.is_stuck = true;
  EXPECT_EQ(evidence(stuck, std::nullopt).use, Use::kRefused);
  EXPECT_EQ(evidence(ImuReport{}, pose_that_says(StatusReason::kNoLidar)).use, Use::kUsed);
  EXPECT_EQ(evidence(LidarReport{}, pose_that_says(StatusReason::kNoLidar), at_s(1)).use, Use::kRefused);
  EXPECT_EQ(evidence(LidarReport{}, pose_that_says(StatusReason::kInnovation), at_s(1)).use, Use::kDoubted);
  std::optional<PoseSample> starting = pose_that_says(StatusReason::kNoImu);
  starting->status = static_cast<std::uint32_t>(TrackingStatus::kInitialising);
  EXPECT_EQ(evidence(ImuReport{}, starting).use, Use::kUsed) << "a pose that is being made accuses nobody";
}

TEST(SensorEvidence, TheBackEndSaysWhatItThinksOfTheReceiver) {
  using Use = SensorEvidence::Use;
  EXPECT_EQ(evidence(GnssReport{}, std::nullopt).use, Use::kUsed);
  EXPECT_EQ(evidence(GnssReport{}, GnssState{.trust = GnssTrust::kDoubtful, .latency = {}}).use, Use::kDoubted);
  EXPECT_EQ(evidence(GnssReport{}, GnssState{.trust = GnssTrust::kFaulty, .latency = {}}).use, Use::kRefused);
  GnssReport report;
  report.sentences.sentences = 4;
  report.last_sentence = at_s(10);
  EXPECT_EQ(evidence(report, std::nullopt).spoke, at_s(10));
  EXPECT_FALSE(evidence(report, std::nullopt).good_at);
}

TEST(Supervisor, ABudgetIsToldOnceItIsReached) {
  std::vector<std::string> lines;
  Supervisor supervisor{std::chrono::seconds{10}, [&](LogLevel, const std::string& line) { lines.push_back(line); }};
  std::uint64_t forgotten = 0;
  supervisor.watch_budget({"map", "without the oldest", [&] { return forgotten; }});
  supervisor.look(at_s(1));
  EXPECT_TRUE(lines.empty());
  for (const double s : {2.0, 3.0, 30.0}) {
    forgotten += 5;
    supervisor.look(at_s(s));
  }
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0], "budget_map state=reached, continuing without the oldest: keyframes=5");
}

TEST(Supervisor, ThePoseIsToldWithItsReasonsByName) {
  PoseSample sample;
  sample.status = static_cast<std::uint32_t>(TrackingStatus::kDegraded);
  sample.reasons = bit(StatusReason::kNoImu) | bit(StatusReason::kLidarIncomplete);
  const Condition degraded = condition(sample);
  EXPECT_EQ(degraded.level, LogLevel::kWarning);
  EXPECT_EQ(degraded.state, "status=DEGRADED reasons=no_imu,lidar_incomplete");
  EXPECT_EQ(condition(std::optional<PoseSample>{}).state, "status=INITIALISING reasons=none");
}

TEST(Supervisor, ARingThatLosesNothingIsNotTalkedAboutAndOneThatDoesIs) {
  std::vector<std::string> lines;
  Supervisor supervisor{Duration{0}, [&](LogLevel, const std::string& line) { lines.push_back(line); }};
  RingCounts counts;
  supervisor.watch_ring("imu", [&] { return counts; });
  supervisor.look(at_s(1));
  EXPECT_TRUE(lines.empty());
  counts.dropped = 7;
  supervisor.look(at_s(2));
  supervisor.look(at_s(3));
  EXPECT_EQ(lines,
            (std::vector<std::string>{"ring_imu state=dropping, continuing: dropped=7", "ring_imu state=flowing"}));
}

TEST(Supervisor, ASensorThatGoesAwayIsAWarningWithItsDevice) {
  std::vector<std::pair<LogLevel, std::string>> lines;
  Supervisor supervisor{Duration{0}, [&](LogLevel level, const std::string& line) { lines.emplace_back(level, line); }};
  SourceHealth health;
  health.state = "healthy";
  health.device = "/dev/ttyACM0";
  supervisor.watch_source("imu", [&] { return health; });
  supervisor.look(at_s(1));
  health.state = "absent";
  health.reason = "no_device";
  supervisor.look(at_s(2));
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].first, LogLevel::kInfo);
  EXPECT_EQ(lines[1].first, LogLevel::kWarning);
  EXPECT_EQ(lines[1].second, "imu state=absent reason=no_device, continuing: received=0 lost=0 device=/dev/ttyACM0");
}

}  // namespace
}  // namespace slamd
