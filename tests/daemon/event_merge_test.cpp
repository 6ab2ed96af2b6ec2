#include "daemon/threads/event_merge.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace slamd {
namespace {

using Kind = NextEvent::Kind;
using namespace std::chrono_literals;

HostTime at_ms(double ms) {
  return HostTime{from_seconds(ms * 1e-3)};
}

constexpr EventMergeConfig kConfig{std::chrono::milliseconds{5}, std::chrono::milliseconds{50}};

TEST(EventMerge, WithAllSourcesWaitingTheOldestGoesAtOnce) {
  EventMerge merge{kConfig};
  const NextEvent event = merge.next({at_ms(3), at_ms(2), at_ms(9)}, at_ms(9));
  EXPECT_EQ(event.kind, Kind::kLidar);
  EXPECT_EQ(event.time, at_ms(2));
}

TEST(EventMerge, WithASourceMissingTheOldestWaitsForTheHoldBack) {
  EventMerge merge{kConfig};
  EXPECT_EQ(merge.next({at_ms(3), at_ms(2), {}}, at_ms(6.9)).kind, Kind::kNone);
  EXPECT_EQ(merge.next({at_ms(3), at_ms(2), {}}, at_ms(7)).kind, Kind::kLidar);
}

TEST(EventMerge, EqualArrivalsGoInAFixedOrder) {
  EventMerge merge{kConfig};
  EXPECT_EQ(merge.next({at_ms(1), at_ms(1), at_ms(1)}, at_ms(9)).kind, Kind::kImu);
  EXPECT_EQ(merge.next({{}, at_ms(1), at_ms(1)}, at_ms(9)).kind, Kind::kLidar);
  EXPECT_EQ(merge.next({{}, {}, at_ms(1)}, at_ms(9)).kind, Kind::kGnss);
}

TEST(EventMerge, NothingComesBeforeTheFirstEvent) {
  EventMerge merge{kConfig};
  EXPECT_EQ(merge.next({}, at_ms(1'000'000)).kind, Kind::kNone);
}

TEST(EventMerge, SilenceIsToldInEqualStepsAndNeverPastTheNextEvent) {
  EventMerge merge{kConfig};
  EXPECT_EQ(merge.next({at_ms(0), {}, {}}, at_ms(5)).kind, Kind::kImu);
  EXPECT_EQ(merge.next({}, at_ms(55)).kind, Kind::kNone);
  const NextEvent first = merge.next({}, at_ms(56));
  EXPECT_EQ(first.kind, Kind::kSilence);
  EXPECT_EQ(first.time, at_ms(50));
  const NextEvent second = merge.next({at_ms(120), {}, {}}, at_ms(130));
  EXPECT_EQ(second.kind, Kind::kSilence);
  EXPECT_EQ(second.time, at_ms(100));
  EXPECT_EQ(merge.next({at_ms(120), {}, {}}, at_ms(130)).kind, Kind::kImu);
}

TEST(EventMerge, ASilenceOfYearsIsToldForAnHourAndThenNoMore) {
  EventMerge merge{{.silence = 10min}};
  EXPECT_EQ(merge.next({at_ms(0), {}, {}}, at_ms(5)).kind, Kind::kImu);
  const HostTime late{std::chrono::years{40}};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(merge.next({late, {}, {}}, late + 5ms).kind, Kind::kSilence);
  EXPECT_EQ(merge.next({late, {}, {}}, late + 5ms).kind, Kind::kImu);
  EXPECT_EQ(merge.next({}, late + 1h).kind, Kind::kSilence) << "a new one begins";
}

/// Three sources of random arrivals, each seen by the merge only `delay` after its arrival.
struct Feed {
  std::array<std::vector<HostTime>, 3> arrivals;
  std::array<std::size_t, 3> used{};

  std::optional<HostTime> head(std::size_t source, HostTime visible_until) const {
    if (used[source] == arrivals[source].size()) return {};
    const HostTime arrival = arrivals[source][used[source]];
    return arrival <= visible_until ? std::optional{arrival} : std::nullopt;
  }
};

Feed random_feed() {
  std::mt19937 random{7};
  Feed feed;
  const std::array<double, 3> mean_ms{5.0, 1.3, 200.0};
  for (std::size_t source = 0; source < 3; ++source) {
    std::exponential_distribution<double> gap{1.0 / mean_ms[source]};
    for (double t = 0; t < 3'000; t += gap(random)) {
      if (t < 1'000 || t > 1'400) feed.arrivals[source].push_back(at_ms(t));
    }
  }
  return feed;
}

std::vector<std::pair<Kind, HostTime>> sequence(Feed feed, double step_ms, Duration delay) {
  EventMerge merge{kConfig};
  std::vector<std::pair<Kind, HostTime>> events;
  for (double now_ms = 0; now_ms < 3'200; now_ms += step_ms) {
    const HostTime now = at_ms(now_ms);
    const auto visible = [&](std::size_t source) { return feed.head(source, now - delay); };
    for (;;) {
      const NextEvent event = merge.next({visible(0), visible(1), visible(2)}, now);
      if (event.kind == Kind::kNone) break;
      events.emplace_back(event.kind, event.time);
      if (event.kind != Kind::kSilence) ++feed.used[static_cast<std::size_t>(event.kind) - 1];
    }
  }
  return events;
}

TEST(EventMerge, TheSequenceDoesNotDependOnHowOftenItIsAskedOrOnTheThreadsDelays) {
  const Feed feed = random_feed();
  auto live = sequence(feed, 0.7, std::chrono::milliseconds{4});
  auto replay = sequence(feed, 3'199, Duration{0});
  const auto is_tail = [](const auto& event) { return event.second > at_ms(3'000); };
  std::erase_if(live, is_tail);
  std::erase_if(replay, is_tail);
  ASSERT_GT(live.size(), 2'000U);
  EXPECT_EQ(live, replay);
}

TEST(EventMerge, AnEventOfASlowThreadIsHandedOutAndCounted) {
  EventMerge merge{EventMergeConfig{}};
  EXPECT_EQ(merge.next({.imu = HostTime{100ms}, .lidar = {}, .gnss = {}}, HostTime{110ms}).kind, NextEvent::Kind::kImu);
  const NextEvent late = merge.next({.imu = HostTime{105ms}, .lidar = HostTime{99ms}, .gnss = {}}, HostTime{110ms});
  EXPECT_EQ(late.kind, NextEvent::Kind::kLidar);
  EXPECT_EQ(merge.late(), 1U);
  EXPECT_EQ(merge.next({.imu = HostTime{105ms}, .lidar = {}, .gnss = {}}, HostTime{111ms}).kind, NextEvent::Kind::kImu);
  EXPECT_EQ(merge.late(), 1U);
}

TEST(EventMerge, AnEventOfTheInstantUpToWhichSilenceWasToldIsLate) {
  EventMerge merge{EventMergeConfig{}};
  ASSERT_EQ(merge.next({.imu = HostTime{100ms}, .lidar = {}, .gnss = {}}, HostTime{110ms}).kind, NextEvent::Kind::kImu);
  const NextEvent silence = merge.next({}, HostTime{160ms});
  ASSERT_EQ(silence.kind, NextEvent::Kind::kSilence);
  ASSERT_EQ(silence.time, HostTime{150ms});
  merge.next({.imu = silence.time, .lidar = {}, .gnss = {}}, HostTime{161ms});
  EXPECT_EQ(merge.late(), 1U);
}

}  // namespace
}  // namespace slamd
