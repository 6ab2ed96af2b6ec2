#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "estimator/map/ikd_tree.hpp"
#include "estimator/map/ikd_tree_path.hpp"
#include "estimator/map/simd8.hpp"

namespace slamd {
namespace {

constexpr float kRoundingMargin = 1.00001F;

/// The least bound that a point at squared distance `d2` is below.
float just_above(float d2) {
  return std::nextafter(d2, kInfinity);
}

/// The k <= 8 nearest so far in two vector registers: ascending, the k-th in lane 7, unused lanes at -infinity.
class NearestEight {
 public:
  NearestEight(std::size_t k, float bound) : first_(8 - k), bound_(bound) {
    constexpr Int8 kLane{0, 1, 2, 3, 4, 5, 6, 7};
    distances_ = kLane < splat8(static_cast<std::int32_t>(first_)) ? splat8(-kInfinity) : splat8(bound);
  }
  [[nodiscard]] float bound() const { return bound_; }

  void offer(float d2, std::uint32_t slot) {
    const Float8 d = splat8(d2);
    const Float8 shifted_distances = __builtin_shufflevector(distances_, splat8(-kInfinity), 8, 0, 1, 2, 3, 4, 5, 6);
    const Int8 shifted_slots = __builtin_shufflevector(slots_, slots_, 0, 0, 1, 2, 3, 4, 5, 6);
    const Int8 before_this = d < distances_;
    const Int8 before_previous = d < shifted_distances;
    const Int8 inserted = before_previous ? shifted_slots : splat8(static_cast<std::int32_t>(slot));
    slots_ = before_this ? inserted : slots_;
    distances_ = min8(distances_, max8(d, shifted_distances));
    bound_ = distances_[7];
  }

  std::size_t write(std::span<Neighbour> out) const {
    alignas(32) float distances[8];
    alignas(32) std::uint32_t slots[8];
    store8(distances_, distances);
    std::memcpy(slots, &slots_, sizeof slots);
    std::size_t found = 0;
    for (std::size_t i = first_; i < 8 && slots[i] != kNoSlot; ++i) out[found++] = {slots[i], distances[i]};
    return found;
  }

 private:
  Float8 distances_ = splat8(0.0F);
  Int8 slots_ = splat8(-1);
  std::size_t first_;
  float bound_;
};

/// The nearest so far for any k, kept sorted in the caller's span.
class NearestSpan {
 public:
  NearestSpan(std::span<Neighbour> out, float bound) : out_(out), bound_(bound) {}
  [[nodiscard]] float bound() const { return bound_; }
  [[nodiscard]] std::size_t found() const { return found_; }

  void offer(float d2, std::uint32_t slot) {
    if (d2 >= bound_) return;
    std::size_t i = found_ < out_.size() ? found_++ : found_ - 1;
    for (; i > 0 && out_[i - 1].squared_distance_m2 > d2; --i) out_[i] = out_[i - 1];
    out_[i] = {slot, d2};
    if (found_ == out_.size()) bound_ = out_.back().squared_distance_m2;
  }

 private:
  std::span<Neighbour> out_;
  float bound_;
  std::size_t found_ = 0;
};

/// All within a fixed bound.
class WithinRadius {
 public:
  WithinRadius(std::span<Neighbour> out, float bound) : out_(out), bound_(bound) {}
  [[nodiscard]] float bound() const { return bound_; }
  [[nodiscard]] std::size_t found() const { return found_; }

  void offer(float d2, std::uint32_t slot) {
    if (found_ < out_.size()) out_[found_] = {slot, d2};
    ++found_;
  }

 private:
  std::span<Neighbour> out_;
  float bound_;
  std::size_t found_ = 0;
};

struct Query8 {
  Float8 x, y, z;
};

template <typename Found>
void scan_leaf(const KdLeaf& leaf, const Query8& query, Found& found) {
  alignas(32) float d2[kKdLeafCapacity];
  std::uint32_t near = 0;
  for (std::uint32_t first = 0; first < kKdLeafCapacity; first += 8) {
    const Float8 d = squared_norm8(load8(leaf.at[0] + first) - query.x, load8(leaf.at[1] + first) - query.y,
                                   load8(leaf.at[2] + first) - query.z);
    store8(d, d2 + first);
    near |= bits8(d < splat8(found.bound())) << first;
  }
  for (; near != 0; near &= near - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(near));
    found.offer(d2[i], leaf.slot[i]);
  }
}

Float8 box_distances(const KdBranch& branch, const Query8& query) {
  const Float8 zero = splat8(0.0F);
  const auto outside = [&](std::size_t a, Float8 q) {
    return max8(max8(load8(branch.lo[a]) - q, q - load8(branch.hi[a])), zero);
  };
  return squared_norm8(outside(0, query.x), outside(1, query.y), outside(2, query.z));
}

struct Unvisited {
  float d2;
  std::uint32_t ref;
};

/// Depth first, nearest box first: each branch sorts its near lanes onto the stack, the nearest on top.
template <typename Found>
void search(const KdNodes& nodes, const Eigen::Vector3f& at, Found& found) {
  const Query8 query{splat8(at.x()), splat8(at.y()), splat8(at.z())};
  std::array<Unvisited, kPathCapacity*(kKdLanes - 1) + 1> stack;
  std::size_t size = 0;
  stack[size++] = {0.0F, KdNodes::kRoot};
  while (size > 0) {
    const Unvisited next = stack[--size];
    if (next.d2 >= found.bound()) continue;
    if (is_leaf(next.ref)) {
      scan_leaf(nodes.leaf(next.ref), query, found);
      continue;
    }
    const KdBranch& branch = nodes.branch(next.ref);
    const Float8 d = box_distances(branch, query);
    alignas(32) float d2[kKdLanes];
    store8(d, d2);
    const std::size_t base = size;
    for (std::uint32_t near = bits8(d < splat8(found.bound())); near != 0; near &= near - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(near));
      std::size_t i = size++;
      for (; i > base && stack[i - 1].d2 < d2[lane]; --i) stack[i] = stack[i - 1];
      stack[i] = {d2[lane], branch.child[lane]};
    }
  }
}

std::size_t search_nearest(const KdNodes& nodes, const Eigen::Vector3f& query, float bound, std::span<Neighbour> out) {
  if (out.size() <= 8) {
    NearestEight best(out.size(), bound);
    search(nodes, query, best);
    return best.write(out);
  }
  NearestSpan best(out, bound);
  search(nodes, query, best);
  return best.found();
}

}  // namespace

std::size_t IkdTree::nearest(const Eigen::Vector3f& query, std::span<Neighbour> out, float max_distance_m) const {
  if (out.empty() || !query.allFinite() || !(max_distance_m >= 0.0F)) return 0;
  return search_nearest(nodes_, query, just_above(max_distance_m * max_distance_m), out);
}

void IkdTree::nearest_many(std::span<const Eigen::Vector3f> queries, std::size_t k, float max_distance_m,
                           std::span<Neighbour> out, std::span<std::uint8_t> counts) const {
  const float widest = just_above(max_distance_m * max_distance_m);
  std::size_t previous = queries.size();  // the last query that had k answers
  for (std::size_t i = 0; i < queries.size(); ++i) {
    counts[i] = 0;
    if (!queries[i].allFinite() || !(max_distance_m >= 0.0F)) continue;
    float bound = widest;
    if (previous < i) {  // its answers are no farther from here than from there plus the way between
      const float reach =
          std::sqrt(out[previous * k + k - 1].squared_distance_m2) + (queries[i] - queries[previous]).norm();
      bound = std::min(bound, reach * reach * kRoundingMargin + std::numeric_limits<float>::min());
    }
    const std::span<Neighbour> answer = out.subspan(i * k, k);
    counts[i] = static_cast<std::uint8_t>(search_nearest(nodes_, queries[i], bound, answer));
    if (counts[i] == k) previous = i;
  }
}

std::size_t IkdTree::radius(const Eigen::Vector3f& query, float radius_m, std::span<Neighbour> out) const {
  if (!query.allFinite() || !(radius_m >= 0.0F)) return 0;
  WithinRadius all(out, just_above(radius_m * radius_m));
  search(nodes_, query, all);
  return all.found();
}

}  // namespace slamd
