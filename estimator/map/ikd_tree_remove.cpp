#include <algorithm>

#include "estimator/map/ikd_tree.hpp"
#include "estimator/map/ikd_tree_path.hpp"

namespace slamd {
namespace {

enum class Fate { kKeep, kRemove, kMixed };

}  // namespace

struct IkdTree::Region {
  Eigen::AlignedBox3f box;
  bool outside;

  [[nodiscard]] bool removes(const std::array<float, 3>& at) const {
    bool inside = true;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      inside = inside && at[a] >= box.min()[axis] && at[a] <= box.max()[axis];
    }
    return inside != outside;
  }

  [[nodiscard]] Fate fate(const KdBox& of) const {
    bool all_inside = true;
    bool none_inside = false;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      all_inside = all_inside && of.lo[a] >= box.min()[axis] && of.hi[a] <= box.max()[axis];
      none_inside = none_inside || !(of.hi[a] >= box.min()[axis] && of.lo[a] <= box.max()[axis]);
    }
    if (all_inside) return outside ? Fate::kKeep : Fate::kRemove;
    if (none_inside) return outside ? Fate::kRemove : Fate::kKeep;
    return Fate::kMixed;
  }
};

bool IkdTree::remove_box(const Eigen::AlignedBox3f& box, std::uint32_t work_budget) {
  return remove({box, false}, work_budget);
}

bool IkdTree::remove_outside(const Eigen::AlignedBox3f& keep, std::uint32_t work_budget) {
  const bool is_box = (keep.min().array() <= keep.max().array()).all();  // false for NaN
  return !is_box || remove({keep, true}, work_budget);
}

bool IkdTree::remove(const Region& region, std::uint32_t work_budget) {
  const std::uint64_t work_end = stats_.work + work_budget;
  const bool complete = remove_below(KdNodes::kRoot, region, work_end);
  reclaim(work_end);
  return complete;
}

bool IkdTree::remove_below(std::uint32_t branch_ref, const Region& region, std::uint64_t work_end) {
  KdBranch& branch = nodes_.branch(branch_ref);
  for (std::uint32_t l = 0; l < kKdLanes; ++l) {
    KdSubtree child = nodes_.lane(branch, l);
    const Fate fate = child.ref == kNoNode ? Fate::kKeep : region.fate(child.box);
    if (fate == Fate::kKeep) continue;
    if (stats_.work >= work_end || detached_.size() >= kMaxDetached) return false;
    ++stats_.work;
    if (fate == Fate::kRemove) {
      detached_.push_back(child.ref);
      size_ -= child.count;
      stats_.removed += child.count;
      KdNodes::set_lane(branch, l, {});
    } else if (is_leaf(child.ref)) {
      filter_leaf(child, region);
      KdNodes::set_lane(branch, l, child);
    } else {
      const bool complete = remove_below(child.ref, region, work_end);
      child = nodes_.summary(child.ref);
      if (child.count == 0) {
        nodes_.release(child.ref);
        child = {};
      }
      KdNodes::set_lane(branch, l, child);
      if (!complete) return false;
    }
  }
  return true;
}

void IkdTree::filter_leaf(KdSubtree& subtree, const Region& region) {
  std::array<KdItem, kKdLeafCapacity> items;
  const std::size_t all = nodes_.gather(subtree, items);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < all; ++i) {
    if (region.removes(items[i].at))
      free_slots_.push_back(items[i].slot);
    else
      items[kept++] = items[i];
  }
  size_ -= all - kept;
  stats_.removed += all - kept;
  stats_.work += all;
  subtree = nodes_.build(std::span(items).first(kept));
}

void IkdTree::reclaim(std::uint64_t work_end) {
  while (!detached_.empty() && stats_.work < work_end) {
    const std::uint32_t ref = detached_.back();
    detached_.pop_back();
    ++stats_.work;
    if (is_leaf(ref)) {
      for (const std::uint32_t slot : nodes_.leaf(ref).slot) {
        if (slot == kNoNode) break;
        free_slots_.push_back(slot);
        ++stats_.work;
      }
    } else {
      for (const std::uint32_t child : nodes_.branch(ref).child)
        if (child != kNoNode) detached_.push_back(child);
    }
    nodes_.release(ref);
  }
}

}  // namespace slamd
