#pragma once
// An incremental k-d tree of points, at most one a voxel: insertion with on-tree downsampling, exact searches, lazy box
// deletion, re-balancing in bounded steps. Keeps no payload: callers keep theirs in arrays indexed by slot.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "estimator/map/kd_nodes.hpp"

namespace slamd {

inline constexpr std::uint32_t kNoSlot = 0xFFFF'FFFFU;

struct IkdTreeConfig {
  float voxel_size_m = 0.5F;
  std::uint32_t max_points = 400'000;  // about 80 bytes each, taken at construction
};

struct Neighbour {
  std::uint32_t slot;
  float squared_distance_m2;
};

struct IkdTreeStats {
  std::uint64_t inserted = 0;          // points that got a slot
  std::uint64_t occupied = 0;          // inserts whose voxel had a point
  std::uint64_t rejected_invalid = 0;  // not finite, or more than kMaxVoxel voxels from the origin
  std::uint64_t rejected_full = 0;     // no slot or no node left
  std::uint64_t removed = 0;
  std::uint64_t rebuilds = 0;  // subtrees built anew from their points
  std::uint64_t rebuilt_points = 0;
  std::uint64_t regrown = 0;  // large subtrees that got new top planes
  std::uint64_t work = 0;     // nodes inspected or divided and points moved by re-balancing and removal
};

/// Not thread-safe: searches are const and may run together, changes need the tree alone. All coordinates are metres in
/// one fixed frame that the owner names (odom in the filter). No allocation after construction. The same calls give the
/// same tree, slots and answers.
class IkdTree {
 public:
  static constexpr float kMaxVoxel = 4'000'000.0F;  // beyond, a float cannot tell neighbouring voxels apart safely

  struct Insertion {
    std::uint32_t slot;  // the voxel's point; kNoSlot when rejected (counted in stats())
    bool is_new;         // false: the voxel had a point, and slot is that one's
  };

  /// Precondition: config.voxel_size_m > 0, 0 < config.max_points < 2^30.
  explicit IkdTree(const IkdTreeConfig& config);

  /// Adds a point unless its voxel has one. The first point of a voxel stays where it is until relocate() or removal.
  /// With is_new the slot is fresh (never used, or given up by a removed point): initialise its payload then.
  /// Cost: one descent; now and then a leaf split or a rebuild of at most kMaxRebuild points.
  Insertion insert(const Eigen::Vector3f& point);

  /// Slot of the point in the voxel around `point`, or kNoSlot.
  [[nodiscard]] std::uint32_t find_voxel(const Eigen::Vector3f& point) const;

  /// Moves a stored point inside its own voxel (for example to the mean of all points seen there). Returns false, and
  /// changes nothing, when the slot is not in the tree or `point` lies in another voxel.
  bool relocate(std::uint32_t slot, const Eigen::Vector3f& point);

  /// Re-balances; called once a scan. Stops when work_budget nodes or points are done, at most one step beyond: a step
  /// is the division of one subtree along seven planes or the rebuild of at most kMaxRebuild points.
  void rebalance(std::uint32_t work_budget);

  /// The out.size() nearest points not farther than max_distance_m (may be infinite), ascending. Returns how many were
  /// found; 0 for a query that is not finite. Exact up to float rounding of the squared distance.
  std::size_t nearest(const Eigen::Vector3f& query, std::span<Neighbour> out, float max_distance_m) const;

  /// nearest() for each query: answers of query i in out[i * k .. i * k + counts[i]). Faster than single calls when
  /// queries that follow each other are close together. Needs k > 0, out.size() >= queries.size() * k,
  /// counts.size() >= queries.size(), k <= 255.
  void nearest_many(std::span<const Eigen::Vector3f> queries, std::size_t k, float max_distance_m,
                    std::span<Neighbour> out, std::span<std::uint8_t> counts) const;

  /// All points not farther than radius_m, in no order. Returns how many there are; the first out.size() are written.
  std::size_t radius(const Eigen::Vector3f& query, float radius_m, std::span<Neighbour> out) const;

  /// Removes the points inside the box, or outside it. What is removed is out of every search at once; its slots come
  /// back to use lazily, in bounded steps here and in rebalance(). Returns false when the budget ended the call before
  /// all was removed: call again. An empty or NaN box contains nothing; remove_outside() ignores such a box.
  bool remove_box(const Eigen::AlignedBox3f& box, std::uint32_t work_budget);
  bool remove_outside(const Eigen::AlignedBox3f& keep, std::uint32_t work_budget);

  /// Position of a slot that insert() returned and that is not removed.
  [[nodiscard]] const Eigen::Vector3f& point(std::uint32_t slot) const { return points_[slot]; }
  /// How many points the slot has held: a payload with another generation is of a removed point.
  [[nodiscard]] std::uint32_t generation(std::uint32_t slot) const { return generations_[slot]; }
  /// Number of points; slots are below slot_capacity().
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t slot_capacity() const { return points_.size(); }
  /// Writes the slots of all points (as many as fit) in tree order, returns how many there are.
  std::size_t slots(std::span<std::uint32_t> out) const;

  [[nodiscard]] const IkdTreeStats& stats() const { return stats_; }
  /// Branches on the longest way from the root; leaves and branches in use. For tests, benches and health.
  [[nodiscard]] std::uint32_t depth() const;
  [[nodiscard]] std::uint32_t leaves() const { return nodes_.leaves().used(); }
  [[nodiscard]] std::uint32_t branches() const { return nodes_.branches().used(); }

  static constexpr std::uint32_t kMaxRebuild = kMaxItems - kKdLeafCapacity;
  static constexpr std::uint32_t kMaxDepth = 48;  // branches; deeper inserts are rejected as full

 private:
  struct Path;    // the branches and lanes from the root to a leaf
  struct Region;  // what a removal removes

  [[nodiscard]] bool valid(const Eigen::Vector3f& point) const;
  [[nodiscard]] Path descend(const Eigen::Vector3f& point) const;
  [[nodiscard]] std::uint32_t find_in_leaf(std::uint32_t ref, const Eigen::Vector3f& point) const;
  bool place(const Path& path, const KdItem& item);
  bool split_leaf(const Path& path, const KdItem& item);
  void keep_shallow(const Path& path);

  [[nodiscard]] bool needs_rebuild(const KdBranch& branch, std::uint32_t count) const;
  void restore(std::uint32_t branch_ref, std::uint32_t count);
  void rebuild(std::uint32_t branch_ref);
  void regrow(std::uint32_t branch_ref, std::uint32_t count);
  void enlist(std::uint32_t branch_ref);
  std::uint32_t next_to_inspect();

  bool remove(const Region& region, std::uint32_t work_budget);
  bool remove_below(std::uint32_t branch_ref, const Region& region, std::uint64_t work_end);
  void filter_leaf(KdSubtree& subtree, const Region& region);
  void reclaim(std::uint64_t work_end);

  KdNodes nodes_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<std::uint32_t> generations_;
  std::vector<std::uint32_t> free_slots_;
  std::vector<std::uint32_t> detached_;  // subtrees cut off by a removal whose slots are not reclaimed yet
  std::vector<std::uint32_t> agenda_;    // branches that rebalance() inspects first
  std::vector<KdItem> scratch_;
  std::size_t size_ = 0;
  std::uint32_t sweep_ = 0;  // the branch that rebalance() inspected last in its turns over all
  IkdTreeStats stats_;
};

}  // namespace slamd
