// Logs of CARMEN: what a line says, what is told of bad ones, stamps that step back, and the real log.

#include "tools/slam-replay/drive/carmen_log.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tools/slam-replay/drive/carmen_line.hpp"

namespace slamd::replay {
namespace {

std::string file_with(const std::string& text) {
  const std::string path = testing::TempDir() + "/carmen_test.clf";
  std::ofstream{path} << text;
  return path;
}

TEST(CarmenLine, AFlaserIsAScanFromRightToLeftAndWhereTheWheelsSayTheRobotIs) {
  const CarmenLine line = parse_carmen_line("FLASER 4 1.0 2.0 81.83 4.0 9 9 9 1.5 -2.5 0.5 100.25 host 0.25");
  ASSERT_TRUE(line.record && line.record->scan);
  EXPECT_EQ(line.record->x_m, 1.5);
  EXPECT_EQ(line.record->yaw_rad, 0.5);
  EXPECT_EQ(line.record->time_s, 100.25);
  const std::vector<LaserBeam>& beams = line.record->scan->beams;
  ASSERT_EQ(beams.size(), 4U);
  EXPECT_FLOAT_EQ(beams[0].angle_rad, -0.5F * static_cast<float>(M_PI));
  EXPECT_FLOAT_EQ(beams[2].angle_rad, 0.0F);
  EXPECT_EQ(beams[2].range_m, 0.0F) << "81.83 is SICK's word for no return";
  EXPECT_EQ(beams[3].range_m, 4.0F);
}

TEST(CarmenLine, ARobotlaserTellsItsOwnAngles) {
  const CarmenLine line = parse_carmen_line("ROBOTLASER1 0 -1.57 3.14 0.1 50 0.01 0 2 1.0 60.0 1 7 0 0 0 3 4 0.1 0 0 0 0 0 12.5 host 1");
  ASSERT_TRUE(line.record && line.record->scan);
  EXPECT_EQ(line.record->x_m, 3.0);
  EXPECT_EQ(line.record->time_s, 12.5);
  EXPECT_EQ(line.record->scan->beams[1].range_m, 0.0F);
  EXPECT_FLOAT_EQ(line.record->scan->beams[1].angle_rad, -1.47F);
}

TEST(CarmenLine, WhatCannotBeReadHasAReasonAndOtherLinesAreOfNoUse) {
  EXPECT_NE(parse_carmen_line("ODOM 1 2 x 0 0 0 1 host 1").reason, nullptr);
  EXPECT_NE(parse_carmen_line("FLASER 99999999 1").reason, nullptr);
  EXPECT_NE(parse_carmen_line("FLASER 3 1.0 2.0").reason, nullptr);
  EXPECT_NE(parse_carmen_line("ODOM 1 2 nan 0 0 0 1 host 1").reason, nullptr);
  for (const char* text : {"", "# a comment", "SYNC tag", "PARAM robot_width 0.5 host 0"}) {
    const CarmenLine line = parse_carmen_line(text);
    EXPECT_EQ(line.reason, nullptr) << text;
    EXPECT_FALSE(line.record) << text;
  }
}

TEST(CarmenLog, ABadLineIsToldWithFileAndNumberAndTheRestIsRead) {
  const std::string path = file_with("ODOM 0 0 0 0 0 0 10 h 0\nODOM broken\nPARAM robot_frontlaser_offset 0.2 h 0\nODOM 1 0 0 0 0 0 11 h 1\n");
  const CarmenLog log = read_carmen_log(path);
  EXPECT_EQ(log.wheels.size(), 2U);
  EXPECT_EQ(log.bad_lines, 1U);
  ASSERT_EQ(log.faults.size(), 1U);
  EXPECT_TRUE(log.faults[0].starts_with(path + ":2: ")) << log.faults[0];
  EXPECT_EQ(log.laser_forward_m, 0.2);
}

TEST(CarmenLog, AStampThatIsAheadIsPutBetweenItsNeighboursAndRemembered) {
  const CarmenLog log = read_carmen_log(file_with("ODOM 0 0 0 0 0 0 10 h 0\nODOM 1 0 0 0 0 0 10.9 h 0\nODOM 2 0 0 0 0 0 10.2 h 0\nODOM 3 0 0 0 0 0 10.3 h 0\n"));
  ASSERT_EQ(log.wheels.size(), 4U);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_GT(log.wheels[i].time, log.wheels[i - 1].time);
  EXPECT_EQ(log.wheels[1].time, HostTime{from_seconds(10.1)});
  ASSERT_EQ(log.recorded_stamps.count(log.wheels[1].time), 1U);
  EXPECT_EQ(log.recorded_stamps.at(log.wheels[1].time), HostTime{from_seconds(10.9)});
}

TEST(CarmenLog, WhatIsNotThereAndWhatHoldsNothingIsSaid) {
  EXPECT_TRUE(read_carmen_log("/nowhere/at.clf").faults.at(0).ends_with("cannot be opened"));
  const CarmenLog empty = read_carmen_log(file_with("# nothing\n"));
  EXPECT_TRUE(empty.is_empty());
  EXPECT_EQ(empty.faults.size(), 1U);
}

TEST(CarmenLog, TheIntelLogIsReadWhole) {
  const std::string path = SLAMD_SHARED_DATA "/carmen/intel/intel_rebuilt.clf.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const CarmenLog log = read_carmen_log(path);
  EXPECT_TRUE(log.faults.empty());
  EXPECT_EQ(log.wheels.size(), 13631U);
  EXPECT_EQ(log.scans.size(), 7584U);
  for (std::size_t i = 1; i < log.scans.size(); ++i) ASSERT_GT(log.scans[i].time, log.scans[i - 1].time);
}

}  // namespace
}  // namespace slamd::replay
