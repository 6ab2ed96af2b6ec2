#include "daemon/threads/scan_budget.hpp"

#include <gtest/gtest.h>

namespace slamd {
namespace {

using namespace std::chrono_literals;

constexpr ScanBudgetConfig kConfig{.late = 60ms, .hopeless = 200ms};

TEST(ScanBudget, OnTimeAllPointsAreWorkedOn) {
  EXPECT_EQ(scan_share(kConfig, -1ms), 1.0);
  EXPECT_EQ(scan_share(kConfig, 0ms), 1.0);
  EXPECT_EQ(scan_share(kConfig, 60ms), 1.0);
}

TEST(ScanBudget, TheLaterTheFewerButNeverLessThanAQuarter) {
  double last = 1.0;
  for (Duration lateness = 61ms; lateness < 200ms; lateness += 1ms) {
    const double share = scan_share(kConfig, lateness);
    ASSERT_LE(share, last);
    ASSERT_GE(share, 0.25);
    last = share;
  }
  EXPECT_EQ(last, 0.25);
}

TEST(ScanBudget, WhatIsHopelesslyLateIsLetGo) {
  EXPECT_EQ(scan_share(kConfig, 200ms), 0.0);
  EXPECT_EQ(scan_share(kConfig, 1h), 0.0);
}

}  // namespace
}  // namespace slamd
