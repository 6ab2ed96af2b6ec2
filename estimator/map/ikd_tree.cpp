#include "estimator/map/ikd_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "estimator/map/ikd_tree_path.hpp"
#include "estimator/map/simd8.hpp"

namespace slamd {
namespace {

// Nodes for a tree whose leaves are on average a bit more than a third full; measured fill is two thirds.
constexpr std::uint32_t kPointsPerLeaf = 6;
constexpr std::uint32_t kLeavesPerBranch = 3;
constexpr std::uint32_t kSpareNodes = 1024;

std::array<float, 3> array_of(const Eigen::Vector3f& point) {
  return {point.x(), point.y(), point.z()};
}

/// Bit i: point i of the leaf is in the voxel with the lower corner `corner` (in voxels).
std::uint32_t in_voxel(const KdLeaf& leaf, const KdNodes& nodes, const std::array<float, 3>& corner) {
  std::uint32_t bits = 0;
  const Float8 scale = splat8(nodes.in_voxels(1.0F));
  for (std::uint32_t first = 0; first < kKdLeafCapacity; first += 8) {
    Int8 inside = splat8(-1);
    for (std::size_t a = 0; a < 3; ++a) {
      const Float8 at = load8(leaf.at[a] + first) * scale;
      inside &= (at >= splat8(corner[a])) & (at < splat8(corner[a] + 1.0F));
    }
    bits |= bits8(inside) << first;
  }
  return bits;
}

std::uint32_t lane_of(const KdBranch& branch, const std::array<float, 3>& voxels) {
  std::uint32_t heap = 0;
  while (heap < kKdPlanes)
    heap = 2 * heap + 1 + static_cast<std::uint32_t>(voxels[branch.axis[heap]] >= branch.plane[heap]);
  return heap - kKdPlanes;
}

void grow_lane(KdBranch& branch, std::uint32_t lane, const std::array<float, 3>& at) {
  for (std::size_t a = 0; a < 3; ++a) {
    branch.lo[a][lane] = std::min(branch.lo[a][lane], at[a]);
    branch.hi[a][lane] = std::max(branch.hi[a][lane], at[a]);
  }
}

/// The highest plane not in use above a lane, or kKdPlanes. The lane is then the first one below it.
std::uint32_t unused_plane_above(const KdBranch& branch, std::uint32_t lane) {
  std::uint32_t heap = 0;
  for (std::uint32_t bit = 4; bit > 0 && branch.plane[heap] != kInfinity; bit /= 2)
    heap = 2 * heap + 1 + static_cast<std::uint32_t>((lane & bit) != 0);
  return std::min(heap, kKdPlanes);
}

void set_plane(KdBranch& branch, std::uint32_t heap, const KdPlane& plane) {
  branch.plane[heap] = plane.position;
  branch.axis[heap] = static_cast<std::uint8_t>(plane.axis);
}

}  // namespace

IkdTree::IkdTree(const IkdTreeConfig& config)
    : nodes_(config.voxel_size_m, config.max_points / kPointsPerLeaf + kSpareNodes,
             config.max_points / kPointsPerLeaf / kLeavesPerBranch + kSpareNodes),
      points_(config.max_points, Eigen::Vector3f::Zero()),
      generations_(config.max_points, 0),
      free_slots_(config.max_points),
      scratch_(kMaxItems) {
  for (std::uint32_t i = 0; i < config.max_points; ++i) free_slots_[i] = config.max_points - 1 - i;
  agenda_.reserve(kMaxAgenda);
  detached_.reserve(kMaxDetached + kKdLanes * kPathCapacity);
}

bool IkdTree::valid(const Eigen::Vector3f& point) const {
  const float limit = kMaxVoxel;  // comparisons with NaN are false
  return std::abs(nodes_.in_voxels(point.x())) < limit && std::abs(nodes_.in_voxels(point.y())) < limit &&
         std::abs(nodes_.in_voxels(point.z())) < limit;
}

IkdTree::Path IkdTree::descend(const Eigen::Vector3f& point) const {
  const std::array<float, 3> voxels{nodes_.in_voxels(point.x()), nodes_.in_voxels(point.y()),
                                    nodes_.in_voxels(point.z())};
  Path path;
  std::uint32_t ref = KdNodes::kRoot;
  while (!is_leaf(ref)) {  // kNoNode counts as a leaf
    const KdBranch& branch = nodes_.branch(ref);
    const std::uint32_t lane = lane_of(branch, voxels);
    path.steps[path.length++] = {ref, lane};
    ref = branch.child[lane];
  }
  path.end = ref;
  return path;
}

std::uint32_t IkdTree::find_in_leaf(std::uint32_t ref, const Eigen::Vector3f& point) const {
  if (ref == kNoNode) return kNoSlot;
  const KdLeaf& leaf = nodes_.leaf(ref);
  const std::array<float, 3> corner{std::floor(nodes_.in_voxels(point.x())), std::floor(nodes_.in_voxels(point.y())),
                                    std::floor(nodes_.in_voxels(point.z()))};
  const std::uint32_t bits = in_voxel(leaf, nodes_, corner);
  return bits == 0 ? kNoSlot : leaf.slot[std::countr_zero(bits)];
}

std::uint32_t IkdTree::find_voxel(const Eigen::Vector3f& point) const {
  return valid(point) ? find_in_leaf(descend(point).end, point) : kNoSlot;
}

IkdTree::Insertion IkdTree::insert(const Eigen::Vector3f& point) {
  if (!valid(point)) {
    ++stats_.rejected_invalid;
    return {kNoSlot, false};
  }
  const Path path = descend(point);
  const std::uint32_t present = find_in_leaf(path.end, point);
  if (present != kNoSlot) {
    ++stats_.occupied;
    return {present, false};
  }
  if (free_slots_.empty() || !place(path, {array_of(point), free_slots_.back()})) {
    ++stats_.rejected_full;
    return {kNoSlot, false};
  }
  const std::uint32_t slot = free_slots_.back();
  free_slots_.pop_back();
  points_[slot] = point;
  ++generations_[slot];
  ++size_;
  ++stats_.inserted;
  for (std::uint32_t i = 0; i + 1 < path.length; ++i) {  // place() has done the last step
    KdBranch& branch = nodes_.branch(path.steps[i].branch);
    grow_lane(branch, path.steps[i].lane, array_of(point));
    ++branch.count[path.steps[i].lane];
  }
  const auto [last, lane] = path.steps[path.length - 1];
  if (!is_leaf(nodes_.branch(last).child[lane])) keep_shallow(path);
  return {slot, true};
}

bool IkdTree::place(const Path& path, const KdItem& item) {
  const auto [branch_ref, lane] = path.steps[path.length - 1];
  KdBranch& branch = nodes_.branch(branch_ref);
  const std::uint32_t count = branch.count[lane];
  if (path.end == kNoNode) {
    if (nodes_.leaves().available() == 0) return false;
    branch.child[lane] = nodes_.make_leaf();
  } else if (count == kKdLeafCapacity) {
    return split_leaf(path, item);
  }
  KdLeaf& leaf = nodes_.leaf(branch.child[lane]);
  for (std::size_t a = 0; a < 3; ++a) leaf.at[a][count] = item.at[a];
  leaf.slot[count] = item.slot;
  ++branch.count[lane];
  grow_lane(branch, lane, item.at);
  return true;
}

bool IkdTree::split_leaf(const Path& path, const KdItem& item) {
  if (path.length >= kMaxDepth || nodes_.leaves().available() < 1 || nodes_.branches().available() < 1) return false;
  const auto [branch_ref, lane] = path.steps[path.length - 1];
  KdBranch& branch = nodes_.branch(branch_ref);
  std::array<KdItem, kKdLeafCapacity + 1> items;
  items[nodes_.gather(nodes_.lane(branch, lane), items)] = item;
  const KdPlane plane = nodes_.choose_plane(items);
  const std::size_t left = nodes_.partition(items, plane);
  const KdSubtree left_leaf = nodes_.build(std::span(items).first(left));
  const KdSubtree right_leaf = nodes_.build(std::span(items).subspan(left));
  const std::uint32_t heap = unused_plane_above(branch, lane);
  if (heap < kKdPlanes) {
    set_plane(branch, heap, plane);
    KdNodes::set_lane(branch, lane, left_leaf);
    KdNodes::set_lane(branch, first_lane(2 * heap + 2), right_leaf);
    return true;
  }
  const std::uint32_t below = nodes_.make_branch();
  set_plane(nodes_.branch(below), 0, plane);
  KdNodes::set_lane(nodes_.branch(below), 0, left_leaf);
  KdNodes::set_lane(nodes_.branch(below), first_lane(2), right_leaf);
  KdNodes::set_lane(branch, lane, nodes_.summary(below));
  return true;
}

bool IkdTree::relocate(std::uint32_t slot, const Eigen::Vector3f& point) {
  if (find_voxel(point) != slot || slot == kNoSlot) return false;
  const Path path = descend(point);
  for (std::uint32_t i = 0; i < path.length; ++i)
    grow_lane(nodes_.branch(path.steps[i].branch), path.steps[i].lane, array_of(point));
  KdLeaf& leaf = nodes_.leaf(path.end);
  const auto place = std::find(std::begin(leaf.slot), std::end(leaf.slot), slot) - std::begin(leaf.slot);
  for (std::size_t a = 0; a < 3; ++a) leaf.at[a][place] = point[static_cast<Eigen::Index>(a)];
  points_[slot] = point;
  return true;
}

std::size_t IkdTree::slots(std::span<std::uint32_t> out) const {
  std::size_t written = 0;
  std::vector<std::uint32_t> unvisited{KdNodes::kRoot};
  while (!unvisited.empty()) {
    const KdBranch& branch = nodes_.branch(unvisited.back());
    unvisited.pop_back();
    for (std::uint32_t l = 0; l < kKdLanes; ++l) {
      if (branch.child[l] == kNoNode) continue;
      if (!is_leaf(branch.child[l])) {
        unvisited.push_back(branch.child[l]);
        continue;
      }
      const KdLeaf& leaf = nodes_.leaf(branch.child[l]);
      for (std::uint32_t i = 0; i < branch.count[l] && written < out.size(); ++i) out[written++] = leaf.slot[i];
    }
  }
  return size_;
}

std::uint32_t IkdTree::depth() const {
  std::uint32_t deepest = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> unvisited{{KdNodes::kRoot, 1}};
  while (!unvisited.empty()) {
    const auto [ref, level] = unvisited.back();
    unvisited.pop_back();
    deepest = std::max(deepest, level);
    for (const std::uint32_t child : nodes_.branch(ref).child)
      if (!is_leaf(child)) unvisited.emplace_back(child, level + 1);
  }
  return deepest;
}

}  // namespace slamd
