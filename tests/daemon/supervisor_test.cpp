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

TEST(SourceHealth, ALidarIsHealthySilentOrRefused) {
  LidarReport report;
  EXPECT_EQ(source_health(report, at_s(10)).state, "silent");
  report.decoder.received = report.decoder.accepted = 5;
  report.last_received = report.last_arrival = at_s(9.5);
  EXPECT_EQ(source_health(report, at_s(10)).state, "healthy");
  EXPECT_EQ(source_health(report, at_s(11)).state, "silent");
  report.last_received = at_s(11);
  report.decoder.rejections.add(Vlp16Rejection::kHdl32e, 3);
  const SourceHealth refused = source_health(report, at_s(11));
  EXPECT_EQ(refused.state, "refused");
  ASSERT_EQ(refused.rejected.size(), 1U);
  EXPECT_EQ(refused.rejected[0].second, 3U);
}

TEST(SourceHealth, AnImuIsAbsentSilentRefusedOrHealthy) {
  ImuReport report;
  EXPECT_EQ(source_health(report, at_s(10)).state, "absent");
  report.device_open = true;
  EXPECT_EQ(source_health(report, at_s(10)).state, "silent");
  report.source.bytes = 100;
  report.last_bytes = at_s(10);
  EXPECT_EQ(source_health(report, at_s(10)).state, "refused");
  report.parser.samples = 3;
  report.last_arrival = at_s(10);
  EXPECT_EQ(source_health(report, at_s(10)).state, "healthy");
  report.device_open = false;
  EXPECT_EQ(source_health(report, at_s(10)).state, "absent");
}

TEST(SourceHealth, AReceiverWithoutAFixIsSaidToHaveNone) {
  GnssReport report;
  report.device_open = true;
  report.sentences.sentences = 4;
  report.last_sentence = at_s(10);
  EXPECT_EQ(source_health(report, at_s(10)).state, "no_fix");
  report.parser.fixes = 1;
  report.last_arrival = at_s(8);
  EXPECT_EQ(source_health(report, at_s(10)).state, "healthy");
  EXPECT_EQ(source_health(report, at_s(20)).state, "silent");
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
  supervisor.look(at_s(2));
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].first, LogLevel::kInfo);
  EXPECT_EQ(lines[1].first, LogLevel::kWarning);
  EXPECT_EQ(lines[1].second, "imu state=absent, continuing without: received=0 lost=0 device=/dev/ttyACM0");
}

}  // namespace
}  // namespace slamd
