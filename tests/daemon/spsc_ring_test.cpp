#include "daemon/ring/spsc_ring.hpp"

#include <gtest/gtest.h>

#include <array>
#include <thread>

namespace slamd {
namespace {

struct Item {
  std::uint64_t number = 0;
  std::array<std::uint64_t, 15> copies{};
};

Item make_item(std::uint64_t number) {
  Item item{.number = number};
  item.copies.fill(number);
  return item;
}

bool is_whole(const Item& item) {
  for (const std::uint64_t copy : item.copies) {
    if (copy != item.number) return false;
  }
  return true;
}

TEST(SpscRing, GivesItemsBackInOrder) {
  SpscRing<int> ring{4};
  EXPECT_EQ(ring.front(), nullptr);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(ring.try_push(i));
  for (int i = 0; i < 3; ++i) {
    ASSERT_NE(ring.front(), nullptr);
    EXPECT_EQ(*ring.front(), i);
    ring.pop();
  }
  EXPECT_EQ(ring.front(), nullptr);
}

TEST(SpscRing, RoundsItsCapacityUpToAPowerOfTwo) {
  EXPECT_EQ(SpscRing<int>{5}.capacity(), 8U);
  EXPECT_EQ(SpscRing<int>{8}.capacity(), 8U);
  EXPECT_EQ(SpscRing<int>{0}.capacity(), 1U);
}

TEST(SpscRing, DropsTheNewestWhenFullAndCountsIt) {
  SpscRing<int> ring{4};
  for (int i = 0; i < 7; ++i) EXPECT_EQ(ring.try_push(i), i < 4);
  const RingCounts counts = ring.counts();
  EXPECT_EQ(counts.pushed, 4U);
  EXPECT_EQ(counts.dropped, 3U);
  EXPECT_EQ(counts.size, 4U);
  EXPECT_EQ(counts.high_water, 4U);
  EXPECT_EQ(*ring.front(), 0);
}

TEST(SpscRing, HighWaterIsTheMostThatEverWaited) {
  SpscRing<int> ring{8};
  for (int round = 0; round < 20; ++round) {
    const int waiting = round == 11 ? 5 : 2;
    for (int i = 0; i < waiting; ++i) ASSERT_TRUE(ring.try_push(i));
    while (ring.front() != nullptr) ring.pop();
  }
  EXPECT_EQ(ring.counts().high_water, 5U);
}

TEST(SpscRing, SlotsAreFilledInPlaceAndSeenOnlyAfterCommit) {
  SpscRing<Item> ring{2};
  Item* slot = ring.claim();
  ASSERT_NE(slot, nullptr);
  *slot = make_item(7);
  EXPECT_EQ(ring.front(), nullptr);
  ring.commit();
  ASSERT_NE(ring.front(), nullptr);
  EXPECT_EQ(ring.front()->number, 7U);
}

TEST(SpscRing, TwoThreadsLoseAndTearNothingThatWasAccepted) {
  constexpr std::uint64_t kItems = 300'000;
  SpscRing<Item> ring{64};
  std::thread producer{[&ring] {
    for (std::uint64_t i = 1; i <= kItems; ++i) {
      while (!ring.try_push(make_item(i))) std::this_thread::yield();
    }
  }};
  std::uint64_t expected = 1;
  bool whole = true;
  while (expected <= kItems) {
    const Item* item = ring.front();
    if (item == nullptr) {
      std::this_thread::yield();
      continue;
    }
    whole = whole && is_whole(*item) && item->number == expected;
    ring.pop();
    ++expected;
  }
  producer.join();
  EXPECT_TRUE(whole);
  EXPECT_EQ(ring.counts().pushed, kItems);
}

// One consumer step for every ten of the producer: nine of ten items have no room and must be counted, none may block.
TEST(SpscRing, TenTimesTooFastAProducerIsCountedItemByItem) {
  constexpr std::uint64_t kItems = 100'000;
  SpscRing<Item> ring{16};
  std::atomic<std::uint64_t> produced{0};
  std::thread producer{[&] {
    for (std::uint64_t i = 1; i <= kItems; ++i) {
      ring.try_push(make_item(i));
      produced.store(i, std::memory_order_release);
    }
  }};
  std::uint64_t taken = 0;
  std::uint64_t previous = 0;
  bool ordered = true;
  const auto take = [&] {
    const Item* item = ring.front();
    if (item == nullptr) return false;
    ordered = ordered && is_whole(*item) && item->number > previous;
    previous = item->number;
    ring.pop();
    ++taken;
    return true;
  };
  while (produced.load(std::memory_order_acquire) < kItems) {
    if (taken * 10 <= produced.load(std::memory_order_acquire)) take();
  }
  producer.join();
  while (take()) {
  }
  const RingCounts counts = ring.counts();
  EXPECT_TRUE(ordered);
  EXPECT_EQ(counts.pushed, taken);
  EXPECT_EQ(counts.pushed + counts.dropped, kItems);
  EXPECT_GT(counts.dropped, 0U);
  EXPECT_EQ(counts.high_water, counts.capacity);
}

}  // namespace
}  // namespace slamd
