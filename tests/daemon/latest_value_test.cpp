#include "daemon/ring/latest_value.hpp"

#include <gtest/gtest.h>

#include <array>
#include <thread>
#include <vector>

#include "daemon/ring/triple_buffer.hpp"

namespace slamd {
namespace {

struct Value {
  std::array<std::uint64_t, 40> words{};
  std::uint32_t odd_tail = 0;
};

Value make_value(std::uint64_t number) {
  Value value;
  value.words.fill(number);
  value.odd_tail = static_cast<std::uint32_t>(number);
  return value;
}

bool is_whole(const Value& value) {
  for (const std::uint64_t word : value.words) {
    if (word != value.words[0]) return false;
  }
  return value.odd_tail == static_cast<std::uint32_t>(value.words[0]);
}

constexpr std::uint64_t kStores = 50'000;

TEST(LatestValue, IsEmptyBeforeTheFirstStore) {
  const LatestValue<Value> latest;
  EXPECT_FALSE(latest.load().has_value());
}

TEST(LatestValue, GivesTheNewestValueOnly) {
  LatestValue<Value> latest;
  latest.store(make_value(1));
  latest.store(make_value(2));
  ASSERT_TRUE(latest.load().has_value());
  EXPECT_EQ(latest.load()->words[0], 2U);
}

TEST(LatestValue, ManyReadersNeverSeeATornOrOlderValue) {
  LatestValue<Value> latest;
  latest.store(make_value(1));
  std::array<bool, 3> good{};
  std::vector<std::thread> readers;
  for (bool& verdict : good) {
    readers.emplace_back([&latest, &verdict] {
      std::uint64_t previous = 0;
      bool ok = true;
      while (previous < kStores) {
        const std::optional<Value> value = latest.load();
        if (!value) continue;  // the writer was preempted inside a store
        ok = ok && is_whole(*value) && value->words[0] >= previous;
        previous = value->words[0];
      }
      verdict = ok;
    });
  }
  for (std::uint64_t i = 2; i <= kStores; ++i) latest.store(make_value(i));
  for (std::thread& reader : readers) reader.join();
  for (const bool verdict : good) EXPECT_TRUE(verdict);
}

TEST(TripleBuffer, IsEmptyBeforeTheFirstPublishAndThenKeepsItsValue) {
  TripleBuffer<std::vector<int>> buffer;
  EXPECT_EQ(buffer.load(), nullptr);
  buffer.store({1, 2, 3});
  ASSERT_NE(buffer.load(), nullptr);
  EXPECT_EQ(buffer.load()->size(), 3U);
  EXPECT_EQ(buffer.load()->size(), 3U);
}

TEST(TripleBuffer, TheReaderNeverSeesATornOrOlderValue) {
  TripleBuffer<Value> buffer;
  std::thread writer{[&buffer] {
    for (std::uint64_t i = 1; i <= kStores; ++i) buffer.store(make_value(i));
  }};
  std::uint64_t previous = 0;
  bool ok = true;
  while (previous < kStores) {
    const Value* value = buffer.load();
    if (value == nullptr) continue;
    ok = ok && is_whole(*value) && value->words[0] >= previous;
    previous = value->words[0];
  }
  writer.join();
  EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace slamd
