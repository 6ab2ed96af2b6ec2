// Balance, work and memory of the tree. Its answers are tested in ikd_tree_test.cpp.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "estimator/map/ikd_tree.hpp"
#include "tests/support/random_points.hpp"

namespace slamd {
namespace {

using Eigen::Vector3f;

/// A drive: new points always ahead, in order. Without re-balancing this would be a list.
TEST(IkdTreeBalance, StaysShallowWhenPointsComeSorted) {
  IkdTree tree({.voxel_size_m = 0.5F, .max_points = 110'000});
  for (int i = 0; i < 100'000; ++i) {
    tree.insert({0.5F * static_cast<float>(i / 10), 0.5F * static_cast<float>(i % 10), 0});
    if (i % 2'000 == 1'999) tree.rebalance(4'000);
  }
  EXPECT_EQ(tree.size(), 100'000U);
  EXPECT_GT(tree.stats().regrown, 0U);
  EXPECT_LE(tree.depth(), 14U) << "a perfect tree of eight lanes has five levels";
  EXPECT_LE(tree.leaves(), 100'000U / 6);
}

TEST(IkdTreeBalance, StaysWithinItsDepthWithoutAnyRebalancing) {
  IkdTree tree({.voxel_size_m = 0.5F, .max_points = 110'000});
  for (int i = 0; i < 100'000; ++i) tree.insert({0.5F * static_cast<float>(i), 0, 0});
  EXPECT_EQ(tree.size(), 100'000U);
  EXPECT_LE(tree.depth(), IkdTree::kMaxDepth);
}

/// Work is counted in nodes and points, so that the bound does not depend on the machine.
TEST(IkdTreeBalance, NeverDoesMuchMoreWorkThanItsBudget) {
  IkdTree tree({.voxel_size_m = 0.5F, .max_points = 150'000});
  std::mt19937 random(9);
  constexpr std::uint32_t kBudget = 3'000;
  std::uint64_t most_rebalance = 0;
  std::uint64_t most_insert = 0;
  float ahead = 0.0F;
  for (int batch = 0; batch < 60; ++batch) {
    const std::uint64_t before = tree.stats().work;
    for (Vector3f& p : uniform(random, 2'000, Vector3f(30, 30, 4))) tree.insert(p + Vector3f(ahead, 0, 0));
    ahead += 12.0F;
    const std::uint64_t inserted = tree.stats().work;
    tree.rebalance(kBudget);
    most_insert = std::max(most_insert, inserted - before);
    most_rebalance = std::max(most_rebalance, tree.stats().work - inserted);
  }
  EXPECT_GT(tree.size(), 80'000U);
  EXPECT_LE(most_insert, 6'000U) << "rebuilds on insertion: three moved points for each new one";
  EXPECT_LE(most_rebalance, kBudget + 6'000U) << "one step beyond the budget";

  const Vector3f middle(0.5F * ahead, 0, 0);
  int calls = 0;
  bool complete = false;
  for (; !complete; ++calls) {
    const std::uint64_t before = tree.stats().work;
    complete = tree.remove_outside({middle - Vector3f(50, 9, 9), middle + Vector3f(50, 9, 9)}, 500);
    ASSERT_LE(tree.stats().work - before, 500U + 2 * kKdLeafCapacity);
    ASSERT_LT(calls, 1'000);
  }
  EXPECT_GT(calls, 1);
  EXPECT_LT(tree.size(), 40'000U);
}

/// Scales from one voxel to kilometres, until the tree is full.
TEST(IkdTreeBalance, AccountsForEachInsertWhileItFillsUp) {
  IkdTree tree({.voxel_size_m = 0.5F, .max_points = 60'000});
  std::mt19937 random(15);
  std::vector<Vector3f> offered;
  for (int i = 0; i < 40; ++i) {
    const float spread = std::pow(1.25F, static_cast<float>(i));
    for (const Vector3f& p : uniform(random, 3'000, Vector3f(spread, spread, spread))) offered.push_back(p);
  }
  std::size_t stored = 0;
  for (std::size_t i = 0; i < offered.size(); ++i) {
    stored += static_cast<std::size_t>(tree.insert(offered[i]).is_new);
    if (i % 500 == 0) tree.rebalance(1'000);
  }
  EXPECT_EQ(tree.size(), stored);
  const IkdTreeStats& stats = tree.stats();
  EXPECT_EQ(stats.inserted + stats.occupied + stats.rejected_invalid + stats.rejected_full, offered.size());
  EXPECT_GT(stats.rejected_full, 0U);
  for (const Vector3f& p : uniform(random, 200, Vector3f(50, 50, 50))) {
    const std::uint32_t slot = tree.find_voxel(p);
    if (slot == kNoSlot) continue;
    EXPECT_LT((tree.point(slot) - p).cwiseAbs().maxCoeff(), 0.5F);
  }
}

TEST(IkdTreeBalance, GivesRemovedSlotsBackInBoundedSteps) {
  IkdTree tree({.voxel_size_m = 0.5F, .max_points = 10'000});
  std::mt19937 random(10);
  for (const Vector3f& p : uniform(random, 60'000, Vector3f(10, 10, 10))) tree.insert(p);
  ASSERT_EQ(tree.size(), 10'000U);
  while (!tree.remove_outside({Vector3f(50, 50, 50), Vector3f(51, 51, 51)}, 100)) {
  }
  EXPECT_EQ(tree.size(), 0U) << "gone from the tree at once";
  EXPECT_EQ(tree.stats().removed, 10'000U);
  for (int i = 0; i < 1'000; ++i) tree.rebalance(100);
  for (const Vector3f& p : uniform(random, 60'000, Vector3f(10, 10, 10))) tree.insert(p);
  EXPECT_EQ(tree.size(), 10'000U) << "every slot is back";
  EXPECT_LE(tree.leaves(), 10'000U / 4);
}

}  // namespace
}  // namespace slamd
