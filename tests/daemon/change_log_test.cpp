#include "daemon/threads/change_log.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace slamd {
namespace {

class ChangeLogTest : public ::testing::Test {
 protected:
  void look(const std::string& state, double at_s) {
    log.look("imu", {LogLevel::kInfo, state, " n=1"}, HostTime{from_seconds(at_s)});
  }

  std::vector<std::string> lines;
  ChangeLog log{std::chrono::seconds{5}, [this](LogLevel, const std::string& line) { lines.push_back(line); }};
};

TEST_F(ChangeLogTest, TheFirstConditionAndEveryChangeMakeOneLine) {
  look("state=absent", 0);
  look("state=absent", 1);
  look("state=healthy", 6);
  look("state=healthy", 7);
  EXPECT_EQ(lines, (std::vector<std::string>{"imu state=absent n=1", "imu state=healthy n=1"}));
}

TEST_F(ChangeLogTest, AChangeSoonAfterALineWaitsAndIsThenTold) {
  look("state=absent", 0);
  look("state=healthy", 1);
  EXPECT_EQ(lines.size(), 1U);
  look("state=healthy", 5);
  EXPECT_EQ(lines.back(), "imu state=healthy n=1");
}

TEST_F(ChangeLogTest, AFlutteringStateIsToldOnceAPeriodWithTheNumberOfItsChanges) {
  for (int i = 0; i <= 100; ++i) look(i % 2 == 0 ? "state=absent" : "state=healthy", 0.1 * i);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[1], "imu state=absent n=1 changes=50");
}

TEST_F(ChangeLogTest, AChangeThatWasTakenBackMeanwhileIsStillTold) {
  look("state=healthy", 0);
  look("state=absent", 1);
  look("state=healthy", 2);
  look("state=healthy", 5);
  EXPECT_EQ(lines.back(), "imu state=healthy n=1 changes=2");
  EXPECT_EQ(lines.size(), 2U);
}

TEST_F(ChangeLogTest, SubjectsAreIndependent) {
  look("state=absent", 0);
  log.look("gnss", {LogLevel::kWarning, "state=absent", ""}, HostTime{from_seconds(0.1)});
  EXPECT_EQ(lines.back(), "gnss state=absent");
}

}  // namespace
}  // namespace slamd
