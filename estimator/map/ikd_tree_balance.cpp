#include <algorithm>
#include <numeric>

#include "estimator/map/ikd_tree.hpp"
#include "estimator/map/ikd_tree_path.hpp"

namespace slamd {
namespace {

constexpr std::uint32_t kSmall = 48;         // fewer points are not worth a rebuild
constexpr std::uint32_t kLaneFloor = 128;    // a lane of so few points is never too heavy
constexpr std::uint32_t kInspections = 512;  // branches looked at in one call: all are, within a few scans
constexpr std::size_t kSamples = 256;        // points that stand for a large subtree when its planes are chosen

bool changed_much(std::uint32_t count, std::uint32_t built) {
  const std::uint32_t change = count > built ? count - built : built - count;
  return change * 4 >= std::max(count, built);
}

std::uint32_t points_below(const KdBranch& branch) {
  return std::accumulate(std::begin(branch.count), std::end(branch.count), 0U);
}

/// The point of a subtree with the given rank in tree order.
KdItem item_at(const KdNodes& nodes, std::uint32_t ref, std::uint32_t rank) {
  while (!is_leaf(ref)) {
    const KdBranch& branch = nodes.branch(ref);
    std::uint32_t lane = 0;
    while (rank >= branch.count[lane]) rank -= branch.count[lane++];
    ref = branch.child[lane];
  }
  const KdLeaf& leaf = nodes.leaf(ref);
  return {{leaf.at[0][rank], leaf.at[1][rank], leaf.at[2][rank]}, leaf.slot[rank]};
}

void choose_planes(const KdNodes& nodes, std::span<KdItem> samples, std::uint32_t heap, std::span<KdPlane> planes) {
  if (heap >= planes.size() || samples.size() < 2) return;
  planes[heap] = nodes.choose_plane(samples);
  const std::size_t left = nodes.partition(samples, planes[heap]);
  choose_planes(nodes, samples.first(left), 2 * heap + 1, planes);
  choose_planes(nodes, samples.subspan(left), 2 * heap + 2, planes);
}

/// Divides a subtree along the planes below `heap` and hangs the parts into the lanes of `top`.
void distribute(KdNodes& nodes, const KdSubtree& part, std::uint32_t heap, KdBranch& top) {
  if (heap >= kKdPlanes) {
    KdNodes::set_lane(top, first_lane(heap), part);
    return;
  }
  const auto [left, right] = nodes.cut(part, {top.axis[heap], top.plane[heap]});
  distribute(nodes, left, 2 * heap + 1, top);
  distribute(nodes, right, 2 * heap + 2, top);
}

}  // namespace

bool IkdTree::needs_rebuild(const KdBranch& branch, std::uint32_t count) const {
  if (count < kSmall || !changed_much(count, branch.built_count)) return false;
  std::uint32_t heaviest = 0;
  std::uint32_t branches = 0;
  for (std::uint32_t l = 0; l < kKdLanes; ++l) {
    heaviest = std::max(heaviest, branch.count[l]);
    branches += static_cast<std::uint32_t>(!is_leaf(branch.child[l]));
  }
  return (heaviest > kLaneFloor && heaviest * 5 > count * 2) || branches > count / kSmall + 1 ||
         (count <= 2 * kSmall && branches > 0);
}

void IkdTree::restore(std::uint32_t branch_ref, std::uint32_t count) {
  if (count <= kMaxRebuild)
    rebuild(branch_ref);
  else
    regrow(branch_ref, count);
}

void IkdTree::rebuild(std::uint32_t branch_ref) {
  KdBranch& branch = nodes_.branch(branch_ref);
  if (!nodes_.can_build(kMaxRebuild)) return;
  std::size_t taken = 0;
  for (std::uint32_t l = 0; l < kKdLanes; ++l) {
    taken += nodes_.gather(nodes_.lane(branch, l), std::span(scratch_).subspan(taken));
    KdNodes::set_lane(branch, l, {});
  }
  nodes_.build_into(branch, std::span(scratch_).first(taken));
  ++stats_.rebuilds;
  stats_.rebuilt_points += taken;
  stats_.work += taken;
}

void IkdTree::regrow(std::uint32_t branch_ref, std::uint32_t count) {
  const std::span<KdItem> samples = std::span(scratch_).first(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i)
    samples[i] = item_at(nodes_, branch_ref, static_cast<std::uint32_t>((2 * i + 1) * count / (2 * kSamples)));
  std::array<KdPlane, kKdPlanes> planes;
  choose_planes(nodes_, samples, 0, planes);

  const KdSubtree whole = nodes_.summary(branch_ref);
  std::uint32_t crossings = 0;
  for (const KdPlane& plane : planes) crossings += nodes_.crossings(whole, plane);
  stats_.work += kSamples + crossings;
  nodes_.branch(branch_ref).built_count = count;
  if (nodes_.leaves().available() < crossings || nodes_.branches().available() < crossings + 1) return;

  // The old top moves to another node, so that this one, which the parent knows, can carry the new planes.
  const std::uint32_t old_top = nodes_.make_branch();
  KdBranch& top = nodes_.branch(branch_ref);
  nodes_.branch(old_top) = top;
  for (std::uint32_t l = 0; l < kKdLanes; ++l) KdNodes::set_lane(top, l, {});
  for (std::uint32_t h = 0; h < kKdPlanes; ++h) {
    top.axis[h] = static_cast<std::uint8_t>(planes[h].axis);
    top.plane[h] = planes[h].position;
  }
  distribute(nodes_, {old_top, whole.count, whole.box}, 0, top);
  for (const std::uint32_t part : top.child)
    if (!is_leaf(part)) enlist(part);
  ++stats_.regrown;
}

void IkdTree::keep_shallow(const Path& path) {
  std::uint32_t count = static_cast<std::uint32_t>(size_);
  for (std::uint32_t i = 0; i < path.length; ++i) {
    const auto [ref, lane] = path.steps[i];
    const std::uint32_t height = std::min(path.length - i + 1, 26U);
    const KdBranch& branch = nodes_.branch(ref);
    const bool allowed = count <= kMaxRebuild || path.length > kMaxDepth / 2;
    if (allowed && count >= kSmall && count < (kKdLeafCapacity << height) && changed_much(count, branch.built_count)) {
      restore(ref, count);
      return;  // the rest of the way may be gone
    }
    if (!allowed && needs_rebuild(branch, count)) enlist(ref);
    count = branch.count[lane];
  }
}

void IkdTree::enlist(std::uint32_t branch_ref) {
  if (agenda_.size() < agenda_.capacity()) agenda_.push_back(branch_ref);
}

/// Branches known to need work come first, newest first; then all in turn.
std::uint32_t IkdTree::next_to_inspect() {
  if (agenda_.empty()) {
    sweep_ = sweep_ + 1 < nodes_.branches().high_water() ? sweep_ + 1 : 0;
    return sweep_;
  }
  const std::uint32_t ref = agenda_.back();
  agenda_.pop_back();
  return ref;
}

void IkdTree::rebalance(std::uint32_t work_budget) {
  const std::uint64_t work_end = stats_.work + work_budget;
  reclaim(work_end);
  for (std::uint32_t i = 0; i < kInspections && stats_.work < work_end; ++i) {
    const std::uint32_t ref = next_to_inspect();
    const KdBranch& branch = nodes_.branch(ref);
    ++stats_.work;
    if (!branch.in_use) continue;
    const std::uint32_t count = points_below(branch);
    if (needs_rebuild(branch, count)) restore(ref, count);
  }
}

}  // namespace slamd
