#include "tests/endurance/lap.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "tests/endurance/nmea_clock.hpp"
#include "tools/slam-replay/drive/drive.hpp"
#include "tools/slam-replay/drive/drive_folder.hpp"
#include "tools/slam-sim/output/drive_folder.hpp"

namespace slamd::endurance {
namespace {

std::string moved(const std::string& sentence, std::int64_t by_s) {
  std::vector<std::uint8_t> bytes{sentence.begin(), sentence.end()};
  move_sentence(bytes, by_s);
  return {bytes.begin(), bytes.end()};
}

TEST(NmeaClock, GoesOnOverMidnightAndTheEndOfTheYear) {
  EXPECT_EQ(moved("$GPRMC,235959.50,A,4807.038,N,01131.000,E,022.4,084.4,311226,,,A*51\r\n", 2),
            "$GPRMC,000001.50,A,4807.038,N,01131.000,E,022.4,084.4,010127,,,A*51\r\n");
  EXPECT_EQ(moved("$GPZDA,235959.00,31,12,2026,00,00*60\r\n", 1), "$GPZDA,000000.00,01,01,2027,00,00*61\r\n");
}

TEST(NmeaClock, LeavesSentencesWithoutTimeAndBytesThatAreNoneAsTheyAre) {
  for (const std::string text : {"$GPGSA,A,3,04,05,,09,12,,,24,,,,,2.5,1.3,2.1*39\r\n", "", "$", "*", "$GPGGA*00\r\n", "noise,1,2"}) {
    EXPECT_EQ(moved(text, 7), text);
  }
}

/// A folder that goes when the test ends.
struct Folder {
  std::string path = ::testing::TempDir() + "slamd-lap-" + std::to_string(::getpid()) + "/";
  ~Folder() { std::filesystem::remove_all(path); }
};

TEST(Lap, RepeatedIsADriveWithoutJumpsLossesOrGaps) {
  Folder folder;
  sim::DriveSpec spec;
  spec.world = sim::WorldKind::kOpenField;
  spec.course.kind = sim::CourseKind::kStandstill;
  spec.max_duration_s = 6.3;
  spec.lidar.clock_skew_ppm = 0.0;
  spec.imu.clock_skew_ppm = 0.0;
  sim::Simulation simulation{spec};
  {
    sim::DriveFolder out{folder.path, {.host_start_ns = 1'000'000'000'000, .serial_bytes = true}};
    while (!simulation.done()) {
      for (const sim::WireEvent& event : simulation.next_slice()) out.write(event);
    }
  }
  const Result<LapPlan> plan = plan_lap(folder.path);
  ASSERT_TRUE(plan);
  const Lap lap{folder.path, *plan};
  std::filesystem::create_directory(folder.path + "repeated");
  for (std::size_t wire = 0; wire < Lap::kWires.size(); ++wire) {
    lap.write(wire, 2 * plan->period + std::chrono::milliseconds{1}, folder.path + "repeated/" + Lap::kWires[wire]);
  }
  replay::Drive drive{replay::open_drive_folder(folder.path + "repeated", {}), {}};
  std::uint64_t fixes = 0;
  for (replay::Event event = drive.next(); !std::holds_alternative<std::monostate>(event); event = drive.next()) {
    fixes += std::holds_alternative<const GnssFix*>(event) ? 1 : 0;
  }
  const replay::StreamReport lidar = drive.sensors().lidar->report();
  EXPECT_EQ(lidar.refused(), 0U);
  EXPECT_NEAR(static_cast<double>(lidar.items), 3.0 * static_cast<double>(plan->seconds) / 1.327104e-3, 6.0);
  EXPECT_EQ(lidar.missing + lidar.clock_jumps, 0U);
  const replay::StreamReport imu = drive.sensors().imu->report();
  EXPECT_EQ(imu.items, static_cast<std::uint64_t>(600 * plan->seconds));
  EXPECT_EQ(imu.missing + imu.resets + imu.refused(), 0U);
  EXPECT_GE(fixes, static_cast<std::uint64_t>(3 * plan->seconds - 3));
}

}  // namespace
}  // namespace slamd::endurance
