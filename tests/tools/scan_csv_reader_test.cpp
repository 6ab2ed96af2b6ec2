// scan.csv and wheel.csv of a drive folder: what is whole is read, the first bad line is told with its number and the reason.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tools/slam-replay/drive/drive.hpp"
#include "tools/slam-replay/drive/drive_folder.hpp"
#include "tools/slam-replay/drive/scan_csv_reader.hpp"

namespace slamd::replay {
namespace {

constexpr const char* kHeader = "t_ns,angle_begin_rad,angle_step_rad,beam_s,range_max_m,ranges_m\n";

TEST(ScanCsvReader, ALineBecomesAScan) {
  std::istringstream text{std::string(kHeader) + "5000000000,-1.5,0.5,0.01,3.5,1.25;0;4.0;0.5\r\n"};
  ScanCsvReader reader{text};
  const std::optional<LaserScan> scan = reader.next();
  ASSERT_TRUE(scan);
  EXPECT_EQ(to_ns(scan->arrival), 5'000'000'000);
  EXPECT_EQ(to_ns(scan->time), 4'970'000'000);
  EXPECT_FLOAT_EQ(scan->range_max_m, 3.5F);
  ASSERT_EQ(scan->beams.size(), 4U);
  EXPECT_FLOAT_EQ(scan->beams[2].angle_rad, -0.5F);
  EXPECT_FLOAT_EQ(scan->beams[3].time_s, 0.03F);
  EXPECT_FLOAT_EQ(scan->beams[0].range_m, 1.25F);
  EXPECT_EQ(scan->beams[1].range_m, 0.0F);
  EXPECT_EQ(scan->beams[2].range_m, 0.0F) << "beyond range_max_m";
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(reader.bad_lines().count, 0U);
}

TEST(ScanCsvReader, AScanOfUnknownTimingIsOneOfAnInstant) {
  std::istringstream text{"5000000000,0,0.1,0,30,1;2;3\n"};
  ScanCsvReader reader{text};
  const std::optional<LaserScan> scan = reader.next();
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->time, scan->arrival);
  EXPECT_EQ(scan->beams[2].time_s, 0.0F);
}

struct BadLine {
  const char* line;
  const char* reason;
};
class BadScanLine : public testing::TestWithParam<BadLine> {};

TEST_P(BadScanLine, IsSkippedAndToldWithItsNumber) {
  std::istringstream text{std::string(kHeader) + "1000000000,0,0.1,0,30,1\n" + GetParam().line + "\n2000000000,0,0.1,0,30,2\n"};
  ScanCsvReader reader{text};
  ASSERT_TRUE(reader.next());
  const std::optional<LaserScan> after = reader.next();
  ASSERT_TRUE(after);
  EXPECT_EQ(to_ns(after->arrival), 2'000'000'000) << "the line after is read";
  EXPECT_EQ(reader.bad_lines().text("scan.csv"), std::string("scan.csv:3: ") + GetParam().reason + " (1 line skipped)");
}

INSTANTIATE_TEST_SUITE_P(
    All, BadScanLine,
    testing::Values(BadLine{"now,0,0.1,0,30,1", "t_ns is no host time in ns"}, BadLine{"-5,0,0.1,0,30,1", "t_ns is no host time in ns"},
                    BadLine{"1500000000,0,x,0,30,1", "one of the columns 2 to 5 is no number"},
                    BadLine{"1500000000,0,0.1,0", "one of the columns 2 to 5 is no number"},
                    BadLine{"1500000000,nan,0.1,0,30,1", "one of the columns 2 to 5 is no number"},
                    BadLine{"1500000000,90,0.1,0,30,1", "angle_begin_rad is beyond two turns"},
                    BadLine{"1500000000,0,0,0,30,1", "angle_step_rad is 0 or beyond half a turn"},
                    BadLine{"1500000000,0,0.1,-1,30,1", "beam_s is not within 0 and 1 s"},
                    BadLine{"1500000000,0,0.1,0.9,30,1;1;1;1;1;1;1;1;1;1;1;1;1", "beam_s and the number of ranges make more than 10 s"},
                    BadLine{"1500000000,0,0.1,0,0,1", "range_max_m is not within 0 and 1000 m"},
                    BadLine{"1500000000,0,0.1,0,30,", "has no ranges"}, BadLine{"1500000000,0,0.1,0,30", "has no ranges"},
                    BadLine{"1500000000,0,0.1,0,30,1;two;3", "one of the ranges is no number"},
                    BadLine{"900000000,0,0.1,0,30,1", "t_ns is before that of the scan above"}));

class Folder {
 public:
  Folder() { std::filesystem::create_directories(path_); }
  ~Folder() { std::filesystem::remove_all(path_); }
  void write(const char* name, const std::string& text) const { std::ofstream{path_ + "/" + name} << text; }
  const std::string& path() const { return path_; }

 private:
  std::string path_ = testing::TempDir() + "scan_drive_" + std::to_string(::getpid());
};

TEST(Drive, ScansAndWheelsComeInOrderOfArrival) {
  const Folder folder;
  folder.write("scan.csv", std::string(kHeader) + "1000000000,0,0.1,0,30,1\n1200000000,0,0.1,0,30,1;2\n");
  folder.write("wheel.csv", "t_ns,sentence\n1010000000,$WODO,1000000,0.10000,0.00000,0.000000*3D\nnonsense\n1110000000,$WODO,1100000,0.20000,0.00000,0.000000*3F\n");
  Drive drive{open_drive_folder(folder.path(), {}), {}};
  ASSERT_TRUE(drive.sensors().laser && drive.sensors().wheel);
  std::string order;
  for (Event event = drive.next(); !std::holds_alternative<std::monostate>(event); event = drive.next()) {
    if (const auto* scan = std::get_if<const LaserScan*>(&event)) order += "s" + std::to_string((*scan)->beams.size());
    if (const auto* wheel = std::get_if<const WheelOdometry*>(&event)) order += (*wheel)->x_m > 0.15 ? "W" : "w";
  }
  EXPECT_EQ(order, "s1wWs2");
  EXPECT_EQ(drive.sensors().wheel->report().complaint,
            folder.path() + "/wheel.csv:3: does not begin with a host time in ns and a comma (1 line skipped)");
  EXPECT_EQ(drive.sensors().laser->report().complaint, "");
  EXPECT_EQ(drive.sensors().laser->report().items, 2U);
}

}  // namespace
}  // namespace slamd::replay
