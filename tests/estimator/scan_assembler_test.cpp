#include "estimator/lidar/scan_assembler.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/spinning_lidar.hpp"

namespace slamd {
namespace {

using test::SpinningLidar;

double ten_metres(HostTime, const Eigen::Vector3d&) { return 10.0; }

struct Assembled {
  std::vector<Scan> scans;
  std::uint64_t points_sent = 0;
  std::uint64_t points_got = 0;
};

/// Feeds `packets` packets, without those that `lost` names.
template <class Lost>
Assembled assemble(ScanAssembler& assembler, const SpinningLidar& lidar, int packets, const Lost& lost) {
  Assembled run;
  const auto keep = [&] {
    Scan scan;
    assembler.take(scan);
    run.points_got += scan.points.size();
    run.scans.push_back(scan);
  };
  for (int i = 0; i < packets; ++i) {
    if (lost(i)) continue;
    const LidarPacket packet = lidar.packet(i, ten_metres);
    run.points_sent += packet.point_count;
    if (assembler.add(packet)) keep();
  }
  if (assembler.finish()) keep();
  return run;
}

Assembled assemble(const SpinningLidar& lidar, int packets) {
  ScanAssembler assembler{ScanAssemblerConfig{}};
  return assemble(assembler, lidar, packets, [](int) { return false; });
}

class EverySpeed : public ::testing::TestWithParam<std::tuple<double, double>> {};
INSTANTIATE_TEST_SUITE_P(ScanAssembler, EverySpeed,
                         ::testing::Combine(::testing::Values(300.0, 597.3, 600.0, 1200.0),
                                            ::testing::Values(0.0, 123.4, 359.99)));

TEST_P(EverySpeed, ScansAreWholeTurnsAndNoPointIsLost) {
  const auto& [rpm, start_deg] = GetParam();
  const double turn_s = 60.0 / rpm;
  const Assembled run = assemble(SpinningLidar{rpm, start_deg}, static_cast<int>(10.3 * turn_s / SpinningLidar::kPacket_s));
  ASSERT_EQ(run.scans.size(), 11U) << "ten turns and the open one";
  EXPECT_EQ(run.points_got, run.points_sent);
  for (std::size_t i = 0; i < 10; ++i) {
    const Scan& scan = run.scans[i];
    EXPECT_TRUE(scan.complete);
    EXPECT_NEAR(to_seconds(scan.end - scan.begin), turn_s, SpinningLidar::kPacket_s);
    EXPECT_NEAR(to_seconds(scan.begin.time_since_epoch()), static_cast<double>(i) * turn_s, SpinningLidar::kPacket_s)
        << "the cut must not creep";
    EXPECT_GT(scan.arrival, scan.end);
    if (i > 0) {
      EXPECT_EQ(scan.begin, run.scans[i - 1].end);
    }
  }
}

TEST_P(EverySpeed, PointTimesCountFromTheScansBegin) {
  const auto& [rpm, start_deg] = GetParam();
  const Assembled run = assemble(SpinningLidar{rpm, start_deg}, 400);
  for (const Scan& scan : run.scans) {
    std::int32_t last_ns = -1;
    for (const LidarPoint& point : scan.points) {
      ASSERT_GT(point.time_offset_ns, last_ns);
      ASSERT_LE(Duration{point.time_offset_ns}, scan.end - scan.begin);
      last_ns = point.time_offset_ns;
    }
    for (const ScanSegment& segment : scan.segments) {
      ASSERT_GE(segment.time_s, 0.0F);
      ASSERT_LE(segment.time_s, to_seconds(scan.end - scan.begin));
    }
  }
}

TEST(ScanAssembler, SegmentsHoldAllReturnsInRange) {
  const Assembled run = assemble(SpinningLidar{}, 200);
  for (const Scan& scan : run.scans) {
    std::size_t returns = 0;
    for (const ScanSegment& segment : scan.segments) returns += segment.count;
    EXPECT_EQ(returns, scan.points.size());
    EXPECT_LT(scan.segments.size(), scan.points.size() / 4);
  }
}

TEST(ScanAssembler, LostPacketsMakeTheScanIncompleteAndOnlyThatOne) {
  ScanAssembler assembler{ScanAssemblerConfig{}};
  const Assembled run = assemble(assembler, SpinningLidar{}, 390, [](int i) { return i >= 110 && i < 118; });
  ASSERT_GE(run.scans.size(), 5U);
  EXPECT_TRUE(run.scans[0].complete);
  EXPECT_FALSE(run.scans[1].complete);
  for (std::size_t i = 2; i < 5; ++i) {
    EXPECT_TRUE(run.scans[i].complete);
    EXPECT_NEAR(to_seconds(run.scans[i].begin.time_since_epoch()), 0.1 * static_cast<double>(i), 0.0014);
  }
}

TEST(ScanAssembler, PacketsLostAtTheSeamDoNotMergeTwoTurns) {
  ScanAssembler assembler{ScanAssemblerConfig{}};
  const Assembled run = assemble(assembler, SpinningLidar{}, 390, [](int i) { return i >= 70 && i < 82; });
  for (const Scan& scan : run.scans) EXPECT_LT(to_seconds(scan.end - scan.begin), 0.12);
}

TEST(ScanAssembler, ALongSilenceEndsTheScan) {
  ScanAssembler assembler{ScanAssemblerConfig{}};
  const Assembled run = assemble(assembler, SpinningLidar{}, 3'000, [](int i) { return i >= 110 && i < 2'500; });
  for (const Scan& scan : run.scans) EXPECT_LT(to_seconds(scan.end - scan.begin), 0.25);
}

TEST(ScanAssembler, AHeadThatDoesNotTurnIsCutByTime) {
  const ScanAssemblerConfig config;
  const Assembled run = assemble(SpinningLidar{0.0, 45.0}, 1'000);
  ASSERT_GE(run.scans.size(), 4U);
  for (const Scan& scan : run.scans) EXPECT_LE(scan.end - scan.begin, config.max_scan_length + from_seconds(0.002));
}

TEST(ScanAssembler, ATimeThatJumpsBackBeginsAnew) {
  ScanAssembler assembler{ScanAssemblerConfig{}};
  const SpinningLidar late{600.0, 0.0, from_ns<HostTime>(10'000'000'000)}, early{600.0};
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(assembler.add(late.packet(i, ten_metres)));
  EXPECT_TRUE(assembler.add(early.packet(30, ten_metres)));
  Scan scan;
  assembler.take(scan);
  for (const LidarPoint& point : scan.points) EXPECT_LT(point.time_offset_ns, 50'000'000);
}

TEST(ScanAssembler, PointsBeyondTheCapacityAreCountedAndMemoryDoesNotGrow) {
  ScanAssemblerConfig config;
  config.max_points = 1'000;
  ScanAssembler assembler{config};
  const Assembled run = assemble(assembler, SpinningLidar{}, 300, [](int) { return false; });
  for (const Scan& scan : run.scans) EXPECT_LE(scan.points.size(), 1'000U);
  EXPECT_EQ(run.points_got + assembler.points_dropped(), run.points_sent);
}

TEST(ScanAssembler, PointsThatAreNotFiniteAreLeftOutAndCounted) {
  ScanAssembler assembler{ScanAssemblerConfig{}};
  LidarPacket packet = SpinningLidar{}.packet(0, ten_metres);
  packet.points[3].x = std::numeric_limits<float>::quiet_NaN();
  packet.points[9].z = std::numeric_limits<float>::infinity();
  assembler.add(packet);
  assembler.finish();
  Scan scan;
  assembler.take(scan);
  EXPECT_EQ(scan.points.size(), packet.point_count - 2U);
  EXPECT_EQ(assembler.points_dropped(), 2U);
}

TEST(ScanAssembler, PacketsWithoutReturnsStillTurn) {
  ScanAssembler assembler{ScanAssemblerConfig{}};
  const SpinningLidar lidar;
  const auto nothing = [](HostTime, const Eigen::Vector3d&) { return std::numeric_limits<double>::infinity(); };
  int scans = 0;
  for (int i = 0; i < 380; ++i) scans += assembler.add(lidar.packet(i, nothing)) ? 1 : 0;
  EXPECT_EQ(scans, 5);
}

TEST(ScanAssembler, FinishWithoutPacketsHasNothing) {
  ScanAssembler assembler{ScanAssemblerConfig{}};
  EXPECT_FALSE(assembler.finish());
}

}  // namespace
}  // namespace slamd
