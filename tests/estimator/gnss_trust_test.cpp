#include "estimator/graph/gnss_trust.hpp"

#include <gtest/gtest.h>

namespace slamd {
namespace {

HostTime at(double s) { return HostTime{from_seconds(s)}; }

/// One fix a second in [from, to), all with the same verdict. Returns how many could be used.
int feed(GnssTrustLatch& latch, int from, int to, bool good) {
  int used = 0;
  for (int s = from; s < to; ++s) used += latch.judge(at(s), good) ? 1 : 0;
  return used;
}

TEST(GnssTrustLatch, TrustIsEarnedByGoodFixesInARow) {
  GnssTrustLatch latch{{}};
  EXPECT_EQ(feed(latch, 0, 8, true), 0);
  EXPECT_EQ(latch.trust(at(8)), GnssTrust::kStarting);
  EXPECT_EQ(feed(latch, 8, 20, true), 12);
  EXPECT_EQ(latch.trust(at(20)), GnssTrust::kTrusted);
}

TEST(GnssTrustLatch, AShortFailureIsForgivenALongOneIsNot) {
  GnssTrustLatch latch{{}};
  feed(latch, 0, 20, true);
  feed(latch, 20, 23, false);
  EXPECT_EQ(latch.trust(at(23)), GnssTrust::kDoubtful);
  EXPECT_EQ(feed(latch, 23, 26, true), 3);
  feed(latch, 26, 36, false);
  EXPECT_EQ(latch.trust(at(36)), GnssTrust::kFaulty);
  EXPECT_EQ(feed(latch, 36, 44, true), 0);
  EXPECT_GT(feed(latch, 44, 50, true), 0);
  EXPECT_EQ(latch.times_faulty(), 1U);
}

TEST(GnssTrustLatch, AFaultySourceThatIsGoodNowAndThenStaysFaulty) {
  GnssTrustLatch latch{{}};
  feed(latch, 0, 20, true);
  feed(latch, 20, 30, false);
  for (int s = 30; s < 90; s += 6) {
    EXPECT_EQ(feed(latch, s, s + 5, true), 0);
    feed(latch, s + 5, s + 6, false);
  }
  EXPECT_EQ(latch.trust(at(90)), GnssTrust::kFaulty);
}

TEST(GnssTrustLatch, SilenceIsAbsenceAndFixesBeforeItDoNotCountTowardsTrust) {
  GnssTrustLatch latch{{}};
  EXPECT_EQ(latch.trust(at(0)), GnssTrust::kAbsent);
  feed(latch, 0, 6, true);
  EXPECT_EQ(latch.trust(at(20)), GnssTrust::kAbsent);
  EXPECT_EQ(feed(latch, 30, 37, true), 0);
}

}  // namespace
}  // namespace slamd
