#include "estimator/map/ikd_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "tests/support/random_points.hpp"

namespace slamd {
namespace {

using Eigen::Vector3f;
using Voxel = std::tuple<int, int, int>;

constexpr float kInf = std::numeric_limits<float>::infinity();

/// The tree beside a plain map of voxels that does the same slowly.
class Checked {
 public:
  explicit Checked(const IkdTreeConfig& config) : tree(config), voxels_per_m_(1.0F / config.voxel_size_m) {}

  void insert(const Vector3f& point) {
    const auto [entry, fresh] = reference.try_emplace(voxel(point), point, kNoSlot);
    const IkdTree::Insertion got = tree.insert(point);
    ASSERT_NE(got.slot, kNoSlot);
    ASSERT_EQ(got.is_new, fresh);
    if (fresh) entry->second.second = got.slot;
    ASSERT_EQ(got.slot, entry->second.second) << "the voxel's slot must not change";
    ASSERT_EQ(tree.point(got.slot), entry->second.first) << "the voxel's first point must stay";
  }

  void remove(const Eigen::AlignedBox3f& box, bool outside) {
    std::erase_if(reference, [&](const auto& entry) { return box.contains(entry.second.first) != outside; });
    for (int calls = 0; !(outside ? tree.remove_outside(box, 500) : tree.remove_box(box, 500)); ++calls)
      ASSERT_LT(calls, 100'000);
  }

  void check_points() const {
    ASSERT_EQ(tree.size(), reference.size());
    std::vector<std::uint32_t> slots(reference.size());
    ASSERT_EQ(tree.slots(slots), reference.size());
    std::vector<std::uint32_t> expected;
    for (const auto& [key, value] : reference) {
      expected.push_back(value.second);
      ASSERT_EQ(tree.find_voxel(value.first), value.second);
    }
    std::sort(slots.begin(), slots.end());
    std::sort(expected.begin(), expected.end());
    ASSERT_EQ(slots, expected);
  }

  void check_searches(const std::vector<Vector3f>& queries, std::size_t k, float max_distance) const {
    std::vector<Neighbour> many(queries.size() * k);
    std::vector<std::uint8_t> counts(queries.size());
    tree.nearest_many(queries, k, max_distance, many, counts);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const std::vector<float> expected = distances(queries[i], max_distance);
      std::vector<Neighbour> single(k);
      single.resize(tree.nearest(queries[i], single, max_distance));
      check_nearest(queries[i], single, k, expected);
      check_nearest(queries[i],
                    {many.begin() + static_cast<std::ptrdiff_t>(i * k),
                     many.begin() + static_cast<std::ptrdiff_t>(i * k + counts[i])},
                    k, expected);
      std::vector<Neighbour> around(expected.size());
      ASSERT_EQ(tree.radius(queries[i], max_distance, around), expected.size());
    }
  }

  IkdTree tree;
  std::map<Voxel, std::pair<Vector3f, std::uint32_t>> reference;

 private:
  Voxel voxel(const Vector3f& p) const {
    const auto cell = [this](float x) { return static_cast<int>(std::floor(x * voxels_per_m_)); };
    return {cell(p.x()), cell(p.y()), cell(p.z())};
  }

  std::vector<float> distances(const Vector3f& query, float max_distance) const {
    std::vector<float> all;
    for (const auto& [key, value] : reference) {
      const float d2 = (value.first - query).squaredNorm();
      if (d2 <= max_distance * max_distance) all.push_back(d2);
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  void check_nearest(const Vector3f& query, const std::vector<Neighbour>& got, std::size_t k,
                     const std::vector<float>& expected) const {
    ASSERT_EQ(got.size(), std::min(k, expected.size()));
    for (std::size_t j = 0; j < got.size(); ++j) {
      ASSERT_FLOAT_EQ(got[j].squared_distance_m2, expected[j]) << "neighbour " << j << " of " << query.transpose();
      ASSERT_FLOAT_EQ((tree.point(got[j].slot) - query).squaredNorm(), expected[j]);
      for (std::size_t other = 0; other < j; ++other) ASSERT_NE(got[j].slot, got[other].slot);
    }
  }

  float voxels_per_m_;
};

TEST(IkdTree, AnswersExactlyOnRandomPoints) {
  std::mt19937 random(1);
  for (const Vector3f& half : {Vector3f(20, 20, 20), Vector3f(60, 60, 1), Vector3f(500, 0.2F, 0.2F)}) {
    Checked checked({.voxel_size_m = 0.5F, .max_points = 20'000});
    for (int batch = 0; batch < 6; ++batch) {
      for (const Vector3f& p : uniform(random, 1'000, half)) checked.insert(p);
      checked.tree.rebalance(2'000);
      checked.check_searches(uniform(random, 20, 1.2F * half), 5, kInf);
      checked.check_searches(uniform(random, 20, half), 12, 3.0F);
    }
    checked.check_points();
  }
}

TEST(IkdTree, AnswersExactlyWhenCoordinatesLieOnTheGrid) {
  std::mt19937 random(2);
  std::uniform_int_distribution<int> cell(-12, 12);
  Checked checked({.voxel_size_m = 0.1F, .max_points = 20'000});
  std::vector<Vector3f> queries;
  for (int i = 0; i < 8'000; ++i) {
    const Vector3f corner = 0.1F * Vector3f(static_cast<float>(cell(random)), static_cast<float>(cell(random)),
                                            static_cast<float>(cell(random)));
    checked.insert(corner);
    if (i % 400 == 0) queries.push_back(corner);
    if (i % 2'000 == 0) checked.tree.rebalance(5'000);
  }
  checked.check_points();
  checked.check_searches(queries, 7, kInf);
  checked.check_searches(queries, 5, 0.1F);
}

TEST(IkdTree, AnswersExactlyOnSortedLinesAndCrosses) {
  Checked checked({.voxel_size_m = 0.5F, .max_points = 20'000});
  for (int i = 0; i < 3'000; ++i) checked.insert({0.5F * static_cast<float>(i), 0.0F, 0.0F});
  for (int i = 3'000; i > 0; --i) checked.insert({0.0F, -0.5F * static_cast<float>(i), 0.0F});
  for (int i = 1; i <= 1'000; ++i) checked.insert({0.0F, 0.0F, 0.5F * static_cast<float>(i)});
  checked.check_points();
  std::mt19937 random(3);
  checked.check_searches(uniform(random, 30, Vector3f(1'500, 1'500, 500)), 5, kInf);
  checked.check_searches(uniform(random, 30, Vector3f(4, 4, 4)), 8, 10.0F);
}

TEST(IkdTree, AnswersExactlyFarFromTheOrigin) {
  std::mt19937 random(4);
  Checked checked({.voxel_size_m = 0.5F, .max_points = 20'000});
  const Vector3f far(-1'500'000.0F, 1'800'000.0F, -900'000.0F);
  for (Vector3f& p : uniform(random, 2'000, Vector3f(40, 40, 40))) checked.insert(p + far);
  for (const Vector3f& p : uniform(random, 2'000, Vector3f(40, 40, 40))) checked.insert(p);
  checked.check_points();
  std::vector<Vector3f> queries = uniform(random, 10, Vector3f(50, 50, 50));
  for (const Vector3f& p : uniform(random, 10, Vector3f(50, 50, 50))) queries.push_back(p + far);
  checked.check_searches(queries, 5, kInf);
}

TEST(IkdTree, KeepsOnePointAVoxelAndItsSlot) {
  IkdTree tree({.voxel_size_m = 0.5F, .max_points = 100});
  const IkdTree::Insertion first = tree.insert({-0.1F, 0.1F, 0.1F});
  EXPECT_TRUE(first.is_new);
  const IkdTree::Insertion second = tree.insert({-0.4F, 0.4F, 0.3F});
  EXPECT_FALSE(second.is_new);
  EXPECT_EQ(second.slot, first.slot);
  EXPECT_NE(tree.insert({0.1F, 0.1F, 0.1F}).slot, first.slot) << "zero divides two voxels";
  EXPECT_EQ(tree.size(), 2U);
  EXPECT_EQ(tree.point(first.slot), Vector3f(-0.1F, 0.1F, 0.1F));
  EXPECT_EQ(tree.find_voxel({-0.3F, 0.2F, 0.2F}), first.slot);
  EXPECT_EQ(tree.find_voxel({-0.3F, 0.2F, 0.6F}), kNoSlot);
  EXPECT_EQ(tree.stats().occupied, 1U);
}

TEST(IkdTree, CountsAndRejectsWhatIsNoPoint) {
  IkdTree tree({.voxel_size_m = 0.5F, .max_points = 100});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {nan, kInf, -kInf, 3e6F, -1e38F}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vector3f point(1, 2, 3);
      point[axis] = bad;
      EXPECT_EQ(tree.insert(point).slot, kNoSlot);
      EXPECT_EQ(tree.find_voxel(point), kNoSlot);
    }
  }
  EXPECT_EQ(tree.stats().rejected_invalid, 15U);
  EXPECT_EQ(tree.size(), 0U);
  tree.insert({1, 2, 3});
  std::vector<Neighbour> out(3);
  EXPECT_EQ(tree.nearest({nan, 0, 0}, out, 5), 0U);
  EXPECT_EQ(tree.nearest({0, 0, 0}, out, nan), 0U);
  EXPECT_EQ(tree.nearest({0, 0, 0}, out, -1), 0U);
  EXPECT_EQ(tree.radius({kInf, 0, 0}, 5, out), 0U);
  EXPECT_EQ(tree.radius({0, 0, 0}, -5, out), 0U);
  std::vector<std::uint8_t> counts{9, 9};
  tree.nearest_many(std::vector<Vector3f>{{nan, 0, 0}, {1, 2, 3}}, 1, 5, out, counts);
  EXPECT_EQ(counts, (std::vector<std::uint8_t>{0, 1}));
}

TEST(IkdTree, IncludesPointsExactlyAtTheLimit) {
  IkdTree tree({.voxel_size_m = 0.5F, .max_points = 100});
  tree.insert({3, 4, 0});
  std::vector<Neighbour> out(2);
  EXPECT_EQ(tree.nearest({0, 0, 0}, out, 5.0F), 1U);
  EXPECT_EQ(tree.radius({0, 0, 0}, 5.0F, out), 1U);
  EXPECT_EQ(tree.nearest({0, 0, 0}, out, 4.99F), 0U);
}

TEST(IkdTree, AnswersNothingWhenEmpty) {
  IkdTree tree({.voxel_size_m = 0.5F, .max_points = 100});
  std::vector<Neighbour> out(5);
  EXPECT_EQ(tree.nearest({0, 0, 0}, out, kInf), 0U);
  EXPECT_EQ(tree.radius({0, 0, 0}, kInf, out), 0U);
  EXPECT_EQ(tree.find_voxel({0, 0, 0}), kNoSlot);
  EXPECT_TRUE(tree.remove_box({Vector3f(-1, -1, -1), Vector3f(1, 1, 1)}, 10));
  tree.rebalance(100);
}

TEST(IkdTree, CountsInsertsAboveItsCapacityAndWorksOn) {
  IkdTree tree({.voxel_size_m = 0.5F, .max_points = 1'000});
  for (int i = 0; i < 1'500; ++i) tree.insert({static_cast<float>(i), 0, 0});
  EXPECT_EQ(tree.size(), 1'000U);
  EXPECT_EQ(tree.stats().rejected_full, 500U);
  EXPECT_FALSE(tree.insert({7.1F, 0, 0}).is_new) << "known voxels are still found";
  EXPECT_TRUE(tree.remove_box({Vector3f(-1, -1, -1), Vector3f(99.5F, 1, 1)}, 10'000));
  EXPECT_EQ(tree.size(), 900U);
  const IkdTree::Insertion again = tree.insert({2'000, 0, 0});
  EXPECT_TRUE(again.is_new);
  EXPECT_EQ(tree.generation(again.slot), 2U) << "the slot of a removed point";
}

TEST(IkdTree, MovesAPointOnlyInsideItsVoxel) {
  IkdTree tree({.voxel_size_m = 0.5F, .max_points = 1'000});
  std::mt19937 random(6);
  for (const Vector3f& p : uniform(random, 900, Vector3f(5, 5, 5))) tree.insert(p);
  const std::uint32_t slot = tree.insert({10.1F, 0.1F, 0.1F}).slot;
  EXPECT_TRUE(tree.relocate(slot, {10.4F, 0.4F, 0.4F}));
  EXPECT_FALSE(tree.relocate(slot, {10.6F, 0.4F, 0.4F}));
  EXPECT_FALSE(tree.relocate(kNoSlot, {70.6F, 0.4F, 0.4F}));
  EXPECT_EQ(tree.point(slot), Vector3f(10.4F, 0.4F, 0.4F));
  std::vector<Neighbour> out(1);
  ASSERT_EQ(tree.nearest({10.45F, 0.45F, 0.45F}, out, kInf), 1U);
  EXPECT_EQ(out[0].slot, slot);
  EXPECT_NEAR(out[0].squared_distance_m2, 0.0075F, 1e-5F);
}

TEST(IkdTree, IgnoresBoxesThatAreNone) {
  IkdTree tree({.voxel_size_m = 0.5F, .max_points = 100});
  tree.insert({1, 2, 3});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(tree.remove_outside(Eigen::AlignedBox3f(), 100));
  EXPECT_TRUE(tree.remove_outside({Vector3f(nan, nan, nan), Vector3f(nan, nan, nan)}, 100));
  EXPECT_TRUE(tree.remove_box({Vector3f(-9, -9, nan), Vector3f(9, 9, nan)}, 100));
  EXPECT_EQ(tree.size(), 1U);
}

TEST(IkdTree, StaysExactThroughALongMixOfChanges) {
  for (const unsigned seed : {11U, 12U, 13U}) {
    std::mt19937 random(seed);
    Checked checked({.voxel_size_m = 0.4F, .max_points = 30'000});
    Vector3f centre = Vector3f::Zero();
    for (int round = 0; round < 60; ++round) {
      centre += Vector3f(4, 1, 0);
      for (const Vector3f& p : uniform(random, 400, Vector3f(15, 15, 3))) checked.insert(p + centre);
      if (round % 7 == 3) {
        const Vector3f corner = centre + uniform(random, 1, Vector3f(12, 12, 2))[0];
        checked.remove({corner, corner + Vector3f(6, 9, 2)}, false);
      }
      if (round % 5 == 4) checked.remove({centre - Vector3f(40, 30, 9), centre + Vector3f(40, 30, 9)}, true);
      checked.tree.rebalance(round % 3 == 0 ? 20'000 : 300);
      std::vector<Vector3f> queries = uniform(random, 6, Vector3f(20, 20, 4));
      for (Vector3f& query : queries) query += centre;
      checked.check_searches(queries, 5, kInf);
      checked.check_searches(queries, 11, 2.0F);
      if (round % 10 == 9) checked.check_points();
    }
    EXPECT_GT(checked.tree.stats().removed, 1'000U);
    EXPECT_GT(checked.tree.stats().rebuilds, 10U);
  }
}

TEST(IkdTree, DoesTheSameTwice) {
  std::vector<std::uint32_t> answers[2];
  for (std::vector<std::uint32_t>& answer : answers) {
    std::mt19937 random(14);
    IkdTree tree({.voxel_size_m = 0.5F, .max_points = 20'000});
    std::vector<Neighbour> out(5);
    for (int round = 0; round < 20; ++round) {
      for (const Vector3f& p : uniform(random, 500, Vector3f(30, 30, 2))) answer.push_back(tree.insert(p).slot);
      tree.rebalance(1'000);
      tree.remove_outside({Vector3f(-25, -30, -5), Vector3f(30, 25, 5)}, 1'000);
      for (const Vector3f& q : uniform(random, 20, Vector3f(30, 30, 2))) {
        const std::size_t found = tree.nearest(q, out, kInf);
        for (std::size_t i = 0; i < found; ++i) answer.push_back(out[i].slot);
      }
    }
    std::vector<std::uint32_t> order(tree.size());
    tree.slots(order);
    answer.insert(answer.end(), order.begin(), order.end());
  }
  EXPECT_EQ(answers[0], answers[1]);
}

}  // namespace
}  // namespace slamd
