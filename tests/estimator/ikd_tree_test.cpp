#include "estimator/map/ikd_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <tuple>
#include <vector>

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
      check_nearest(queries[i], {many.begin() + static_cast<std::ptrdiff_t>(i * k), many.begin() + static_cast<std::ptrdiff_t>(i * k + counts[i])}, k, expected);
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

std::vector<Vector3f> uniform(std::mt19937& random, std::size_t n, const Vector3f& half) {
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  std::vector<Vector3f> points(n);
  for (Vector3f& p : points)
    for (int a = 0; a < 3; ++a) p[a] = half[a] * unit(random);
  return points;
}

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

}  // namespace
}  // namespace slamd
