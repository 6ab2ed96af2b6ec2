#include "estimator/map/kd_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace slamd {
namespace {

constexpr std::size_t kBottomPoints = 96;  // a branch of leaves only: eight leaves with room to grow
constexpr std::uint32_t kMergePoints = kKdLeafCapacity * 3 / 4;
constexpr std::size_t kFewSamples = 31;

/// Median of one coordinate, from at most `kMost` items spread over all of them.
template <std::size_t kMost>
float median(std::span<const KdItem> items, std::uint32_t axis) {
  std::array<float, kMost> samples{};
  const std::size_t stride = (items.size() + kMost - 1) / kMost;
  std::size_t n = 0;
  for (std::size_t i = stride / 2; i < items.size(); i += stride) samples[n++] = items[i].at[axis];
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(n / 2);
  std::nth_element(samples.begin(), middle, samples.begin() + static_cast<std::ptrdiff_t>(n));
  return *middle;
}

struct Division {
  KdPlane plane;
  std::size_t smaller = 0;  // points on the side with fewer
};

/// The better of the two planes that bound the voxel layer of `middle`.
Division divide(std::span<const KdItem> items, const KdNodes& nodes, std::uint32_t axis, float middle) {
  const float layer = std::floor(nodes.in_voxels(middle));
  std::array<std::size_t, 2> left{};
  for (const KdItem& item : items) {
    const float at = nodes.in_voxels(item.at[axis]);
    left[0] += static_cast<std::size_t>(at < layer);
    left[1] += static_cast<std::size_t>(at < layer + 1.0F);
  }
  const auto smaller = [&](std::size_t i) { return std::min(left[i], items.size() - left[i]); };
  if (smaller(0) >= smaller(1)) return {{axis, layer}, smaller(0)};
  return {{axis, layer + 1.0F}, smaller(1)};
}

using Float4 = float __attribute__((vector_size(16)));

/// Axes by falling extent of the items. The fourth lane carries slots and is ignored.
std::array<std::uint32_t, 3> longest_first(std::span<const KdItem> items) {
  static_assert(sizeof(KdItem) == sizeof(Float4));
  Float4 lo{kInfinity, kInfinity, kInfinity, 0};
  Float4 hi = -lo;
  for (const KdItem& item : items) {
    Float4 at;
    std::memcpy(&at, &item, sizeof at);
    lo = at < lo ? at : lo;
    hi = at > hi ? at : hi;
  }
  const Float4 extent = hi - lo;
  std::array<std::uint32_t, 3> axes{0, 1, 2};
  if (extent[1] > extent[0]) std::swap(axes[0], axes[1]);
  if (extent[2] > extent[axes[0]]) std::swap(axes[0], axes[2]);
  if (extent[axes[2]] > extent[axes[1]]) std::swap(axes[1], axes[2]);
  return axes;
}

}  // namespace

KdNodes::KdNodes(float voxel_size_m, std::uint32_t max_leaves, std::uint32_t max_branches)
    : voxels_per_m_(1.0F / voxel_size_m), leaves_(max_leaves), branches_(max_branches) {
  make_branch();  // the first taken is kRoot
}

std::uint32_t KdNodes::make_leaf() {
  const std::uint32_t index = leaves_.take();
  for (auto& axis : leaves_[index].at) std::fill(std::begin(axis), std::end(axis), kInfinity);
  std::fill(std::begin(leaves_[index].slot), std::end(leaves_[index].slot), kNoNode);
  return index | kLeafBit;
}

std::uint32_t KdNodes::make_branch() {
  const std::uint32_t index = branches_.take();
  KdBranch& fresh = branches_[index];
  for (std::uint32_t l = 0; l < kKdLanes; ++l) set_lane(fresh, l, {});
  std::fill(std::begin(fresh.plane), std::end(fresh.plane), kInfinity);
  std::fill(std::begin(fresh.axis), std::end(fresh.axis), std::uint8_t{0});
  fresh.in_use = true;
  fresh.built_count = 0;
  return index;
}

void KdNodes::release(std::uint32_t ref) {
  if (is_leaf(ref)) {
    leaves_.give_back(ref & ~kLeafBit);
    return;
  }
  branches_[ref].in_use = false;
  branches_.give_back(ref);
}

KdSubtree KdNodes::lane(const KdBranch& branch, std::uint32_t lane) const {
  KdSubtree out{branch.child[lane], branch.count[lane], {}};
  for (std::size_t a = 0; a < 3; ++a) {
    out.box.lo[a] = branch.lo[a][lane];
    out.box.hi[a] = branch.hi[a][lane];
  }
  return out;
}

void KdNodes::set_lane(KdBranch& branch, std::uint32_t lane, const KdSubtree& subtree) {
  branch.child[lane] = subtree.ref;
  branch.count[lane] = subtree.count;
  for (std::size_t a = 0; a < 3; ++a) {
    branch.lo[a][lane] = subtree.box.lo[a];
    branch.hi[a][lane] = subtree.box.hi[a];
  }
}

KdSubtree KdNodes::summary(std::uint32_t branch_ref) const {
  KdSubtree out{branch_ref, 0, {}};
  for (std::uint32_t l = 0; l < kKdLanes; ++l) {
    const KdSubtree child = lane(branches_[branch_ref], l);
    out.count += child.count;
    out.box.add(child.box);
  }
  return out;
}

KdPlane KdNodes::choose_plane(std::span<const KdItem> items) const {
  const std::array<std::uint32_t, 3> axes = longest_first(items);
  Division best;
  for (const bool exact : {false, true}) {
    for (const std::uint32_t axis : axes) {
      const float middle = exact ? median<kMaxItems>(items, axis) : median<kFewSamples>(items, axis);
      const Division found = divide(items, *this, axis, middle);
      if (found.smaller > best.smaller) best = found;
      if (best.smaller * 4 >= items.size()) return best.plane;
    }
    if (best.smaller * 8 >= items.size() || items.size() <= kFewSamples) break;
  }
  return best.plane;
}

std::size_t KdNodes::partition(std::span<KdItem> items, const KdPlane& plane) const {
  const auto middle = std::partition(
      items.begin(), items.end(), [&](const KdItem& item) { return in_voxels(item.at[plane.axis]) < plane.position; });
  return static_cast<std::size_t>(middle - items.begin());
}

KdSubtree KdNodes::build_leaf(std::span<const KdItem> items) {
  KdSubtree out{make_leaf(), static_cast<std::uint32_t>(items.size()), {}};
  KdLeaf& fresh = leaf(out.ref);
  for (std::size_t i = 0; i < items.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) fresh.at[a][i] = items[i].at[a];
    fresh.slot[i] = items[i].slot;
    out.box.add(items[i].at);
  }
  return out;
}

KdSubtree KdNodes::build(std::span<KdItem> items) {
  if (items.empty()) return {};
  if (items.size() <= kKdLeafCapacity) return build_leaf(items);
  const std::uint32_t ref = make_branch();
  build_into(branches_[ref], items);
  return summary(ref);
}

void KdNodes::build_into(KdBranch& branch, std::span<KdItem> items) {
  std::fill(std::begin(branch.plane), std::end(branch.plane), kInfinity);
  branch.built_count = static_cast<std::uint32_t>(items.size());
  fill(branch, 0, items, items.size() <= kBottomPoints ? kKdLeafCapacity : kBottomPoints);
}

bool KdNodes::can_build(std::size_t items) const {
  const std::size_t nodes = items / 2 + 2;  // a leaf that a plane made holds at least (17 - 1) / 6 points
  return leaves_.available() >= nodes && branches_.available() >= nodes;
}

void KdNodes::fill(KdBranch& branch, std::uint32_t heap, std::span<KdItem> items, std::size_t limit) {
  if (heap >= kKdPlanes || items.size() <= limit) {
    set_lane(branch, first_lane(heap), build(items));
    return;
  }
  const KdPlane plane = choose_plane(items);
  branch.plane[heap] = plane.position;
  branch.axis[heap] = static_cast<std::uint8_t>(plane.axis);
  const std::size_t left = partition(items, plane);
  fill(branch, 2 * heap + 1, items.first(left), limit);
  fill(branch, 2 * heap + 2, items.subspan(left), limit);
}

std::size_t KdNodes::gather(const KdSubtree& subtree, std::span<KdItem> out) {
  if (subtree.ref == kNoNode) return 0;
  std::size_t taken = 0;
  if (is_leaf(subtree.ref)) {
    const KdLeaf& from = leaf(subtree.ref);
    for (; taken < subtree.count; ++taken)
      out[taken] = {{from.at[0][taken], from.at[1][taken], from.at[2][taken]}, from.slot[taken]};
  } else {
    for (std::uint32_t l = 0; l < kKdLanes; ++l) taken += gather(lane(branches_[subtree.ref], l), out.subspan(taken));
  }
  release(subtree.ref);
  return taken;
}

std::uint32_t KdNodes::crossings(const KdSubtree& subtree, const KdPlane& plane) const {
  if (subtree.ref == kNoNode || in_voxels(subtree.box.hi[plane.axis]) < plane.position ||
      in_voxels(subtree.box.lo[plane.axis]) >= plane.position)
    return 0;
  std::uint32_t nodes = 1;
  if (is_leaf(subtree.ref)) return nodes;
  for (std::uint32_t l = 0; l < kKdLanes; ++l) nodes += crossings(lane(branches_[subtree.ref], l), plane);
  return nodes;
}

std::pair<KdSubtree, KdSubtree> KdNodes::cut(const KdSubtree& subtree, const KdPlane& plane) {
  if (subtree.ref == kNoNode || in_voxels(subtree.box.hi[plane.axis]) < plane.position) return {subtree, {}};
  if (in_voxels(subtree.box.lo[plane.axis]) >= plane.position) return {{}, subtree};
  if (is_leaf(subtree.ref)) return cut_leaf(subtree, plane);
  const std::uint32_t right_ref = make_branch();
  KdBranch& left = branches_[subtree.ref];
  KdBranch& right = branches_[right_ref];
  std::copy(std::begin(left.plane), std::end(left.plane), std::begin(right.plane));
  std::copy(std::begin(left.axis), std::end(left.axis), std::begin(right.axis));
  left.built_count = 0;
  for (std::uint32_t l = 0; l < kKdLanes; ++l) {
    const auto [child_left, child_right] = cut(lane(left, l), plane);
    set_lane(left, l, child_left);
    set_lane(right, l, child_right);
  }
  return {simplified(subtree.ref), simplified(right_ref)};
}

std::pair<KdSubtree, KdSubtree> KdNodes::cut_leaf(const KdSubtree& subtree, const KdPlane& plane) {
  std::array<KdItem, kKdLeafCapacity> items;
  const std::span<KdItem> all(items.data(), gather(subtree, items));
  const std::size_t left = partition(all, plane);
  return {build(all.first(left)), build(all.subspan(left))};
}

KdSubtree KdNodes::simplified(std::uint32_t branch_ref) {
  const KdSubtree whole = summary(branch_ref);
  if (whole.count <= kMergePoints) {
    std::array<KdItem, kMergePoints> items;
    return build(std::span(items.data(), gather(whole, items)));
  }
  for (std::uint32_t l = 0; l < kKdLanes; ++l) {
    const KdSubtree only = lane(branches_[branch_ref], l);
    if (only.count != whole.count) continue;
    release(branch_ref);
    return only;
  }
  return whole;
}

}  // namespace slamd
