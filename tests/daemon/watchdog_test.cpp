#include "daemon/service/watchdog.hpp"

#include <gtest/gtest.h>

namespace slamd {
namespace {

HostTime at_s(double s) { return HostTime{from_seconds(s)}; }

class WatchdogTest : public ::testing::Test {
 protected:
  WatchdogTest() {
    watchdog.watch("estimator", [this] { return estimator; });
    watchdog.watch("server", [this] { return server; });
  }

  std::uint64_t estimator = 0;
  std::uint64_t server = 0;
  Watchdog watchdog{std::chrono::seconds{4}, at_s(0)};
};

TEST_F(WatchdogTest, ItIsFedFourTimesAPeriodWhileAllPartsMoveOn) {
  int fed = 0;
  for (int i = 1; i <= 160; ++i) {
    ++estimator;
    if (i % 2 == 0) ++server;
    if (watchdog.look(at_s(0.1 * i))) ++fed;
  }
  EXPECT_GE(fed, 14);
  EXPECT_LE(fed, 16);
  EXPECT_EQ(watchdog.stuck(at_s(16)), "");
}

TEST_F(WatchdogTest, TimeAloneNeverFeedsIt) {
  for (int i = 1; i <= 100; ++i) EXPECT_FALSE(watchdog.look(at_s(i)));
}

TEST_F(WatchdogTest, OnePartThatStandsStillKeepsItHungryAndIsNamed) {
  for (int i = 1; i <= 30; ++i) {
    ++estimator;
    EXPECT_FALSE(watchdog.look(at_s(0.1 * i)));
    EXPECT_EQ(watchdog.stuck(at_s(0.1 * i)), i > 20 ? "server" : "") << i;
  }
  ++server;
  EXPECT_TRUE(watchdog.look(at_s(3.1)));
  EXPECT_EQ(watchdog.stuck(at_s(3.1)), "");
}

TEST_F(WatchdogTest, PartsNeedNotMoveOnBetweenTwoLooks) {
  ++estimator;
  EXPECT_FALSE(watchdog.look(at_s(1.1)));
  ++server;
  EXPECT_TRUE(watchdog.look(at_s(1.2))) << "both have moved on since it was fed";
}

}  // namespace
}  // namespace slamd
