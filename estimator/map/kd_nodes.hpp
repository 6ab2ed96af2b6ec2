#pragma once
// The nodes of IkdTree: fixed pools and the structural operations on subtrees (build, gather, cut by a plane). Knows
// nothing of slots' owners, queries or of when to re-balance.
//
// A branch is three levels of a binary k-d tree in one node: seven planes in heap order (children of h are 2h+1, 2h+2)
// and up to eight children ("lanes") with their tight boxes side by side, so that one vector instruction tests all.
// A plane lies on the voxel grid, hence a voxel is wholly in one leaf. A plane not in use is at +infinity (everything
// is left of it). Leaves hold up to kKdLeafCapacity points; unused places are at +infinity, farther than any query.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace slamd {

inline constexpr std::uint32_t kKdLanes = 8;
inline constexpr std::uint32_t kKdPlanes = 7;
inline constexpr std::uint32_t kKdLeafCapacity = 16;
inline constexpr std::size_t kMaxItems = 1040;  // most points that are built into a subtree at once
inline constexpr std::uint32_t kNoNode = 0xFFFF'FFFFU;
inline constexpr std::uint32_t kLeafBit = 0x8000'0000U;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct alignas(64) KdLeaf {
  float at[3][kKdLeafCapacity];  // metres
  std::uint32_t slot[kKdLeafCapacity];
};

struct alignas(64) KdBranch {
  float lo[3][kKdLanes];  // tight boxes of the lanes, metres; empty lanes have lo = +inf, hi = -inf
  float hi[3][kKdLanes];
  std::uint32_t child[kKdLanes];  // branch index, leaf index | kLeafBit, or kNoNode
  std::uint32_t count[kKdLanes];  // points below
  float plane[kKdPlanes];         // in voxels (a whole number), +inf when not in use
  std::uint8_t axis[kKdPlanes];
  bool in_use;
  std::uint32_t built_count;  // points below when last built, 0 when never
};

struct KdItem {
  std::array<float, 3> at;  // metres
  std::uint32_t slot;
};

struct KdBox {
  std::array<float, 3> lo{kInfinity, kInfinity, kInfinity};
  std::array<float, 3> hi{-kInfinity, -kInfinity, -kInfinity};

  void add(const KdBox& other) {
    for (std::size_t a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], other.lo[a]);
      hi[a] = std::max(hi[a], other.hi[a]);
    }
  }
  void add(const std::array<float, 3>& point) { add({point, point}); }
};

/// Points whose coordinate in voxels is below `position` are left of the plane.
struct KdPlane {
  std::uint32_t axis = 0;
  float position = kInfinity;
};

struct KdSubtree {
  std::uint32_t ref = kNoNode;
  std::uint32_t count = 0;
  KdBox box;
};

inline bool is_leaf(std::uint32_t ref) {
  return (ref & kLeafBit) != 0;
}

/// A fixed number of nodes with a free list. No allocation after construction.
template <typename Node>
class KdPool {
 public:
  explicit KdPool(std::uint32_t capacity) : nodes_(capacity), free_(capacity) {
    for (std::uint32_t i = 0; i < capacity; ++i) free_[i] = capacity - 1 - i;
  }

  [[nodiscard]] std::uint32_t available() const { return static_cast<std::uint32_t>(free_.size()); }
  [[nodiscard]] std::uint32_t capacity() const { return static_cast<std::uint32_t>(nodes_.size()); }
  [[nodiscard]] std::uint32_t used() const { return capacity() - available(); }

  /// No node at or above this index was ever taken.
  [[nodiscard]] std::uint32_t high_water() const { return high_water_; }

  /// Precondition: available() > 0.
  std::uint32_t take() {
    const std::uint32_t index = free_.back();
    free_.pop_back();
    high_water_ = std::max(high_water_, index + 1);
    return index;
  }
  void give_back(std::uint32_t index) { free_.push_back(index); }

  Node& operator[](std::uint32_t index) { return nodes_[index]; }
  const Node& operator[](std::uint32_t index) const { return nodes_[index]; }

 private:
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> free_;
  std::uint32_t high_water_ = 0;
};

class KdNodes {
 public:
  static constexpr std::uint32_t kRoot = 0;  // always a branch

  KdNodes(float voxel_size_m, std::uint32_t max_leaves, std::uint32_t max_branches);

  /// Coordinate in voxels. Monotone in its argument, rounding included: all grid decisions use this one product.
  [[nodiscard]] float in_voxels(float metres) const { return metres * voxels_per_m_; }

  [[nodiscard]] KdLeaf& leaf(std::uint32_t ref) { return leaves_[ref & ~kLeafBit]; }
  [[nodiscard]] const KdLeaf& leaf(std::uint32_t ref) const { return leaves_[ref & ~kLeafBit]; }
  [[nodiscard]] KdBranch& branch(std::uint32_t ref) { return branches_[ref]; }
  [[nodiscard]] const KdBranch& branch(std::uint32_t ref) const { return branches_[ref]; }
  [[nodiscard]] const KdPool<KdLeaf>& leaves() const { return leaves_; }
  [[nodiscard]] const KdPool<KdBranch>& branches() const { return branches_; }

  /// New empty nodes; precondition: the pool has one.
  std::uint32_t make_leaf();
  std::uint32_t make_branch();
  /// Gives one node back, not those below it.
  void release(std::uint32_t ref);

  [[nodiscard]] KdSubtree lane(const KdBranch& branch, std::uint32_t lane) const;
  static void set_lane(KdBranch& branch, std::uint32_t lane, const KdSubtree& subtree);
  /// Points and box of all lanes together.
  [[nodiscard]] KdSubtree summary(std::uint32_t branch_ref) const;

  /// A plane that divides the items well: across their longest extent, or across another axis when many share the
  /// median's voxel layer. As the voxels are distinct, the smaller side has at least min(n / 8, (n - 1) / 6) items.
  /// Needs 2 <= n <= kMaxItems.
  [[nodiscard]] KdPlane choose_plane(std::span<const KdItem> items) const;
  /// Reorders; returns how many items are left of the plane.
  [[nodiscard]] std::size_t partition(std::span<KdItem> items, const KdPlane& plane) const;

  /// Balanced subtree of items with distinct voxels. Reorders. Precondition: can_build(items.size()).
  KdSubtree build(std::span<KdItem> items);
  /// The same into an existing branch without children.
  void build_into(KdBranch& branch, std::span<KdItem> items);
  [[nodiscard]] bool can_build(std::size_t items) const;

  /// Copies the subtree's points to `out` (which holds them all), gives its nodes back; returns how many.
  std::size_t gather(const KdSubtree& subtree, std::span<KdItem> out);

  /// Number of nodes that a cut divides: what it costs and the most nodes that it needs.
  [[nodiscard]] std::uint32_t crossings(const KdSubtree& subtree, const KdPlane& plane) const;
  /// Divides a subtree into what is left and right of the plane. Subtrees on one side move whole, so that the cost is
  /// the nodes that the plane crosses. Precondition: that many free leaves and branches.
  std::pair<KdSubtree, KdSubtree> cut(const KdSubtree& subtree, const KdPlane& plane);

 private:
  KdSubtree build_leaf(std::span<const KdItem> items);
  void fill(KdBranch& branch, std::uint32_t heap, std::span<KdItem> items, std::size_t limit);
  std::pair<KdSubtree, KdSubtree> cut_leaf(const KdSubtree& subtree, const KdPlane& plane);
  KdSubtree simplified(std::uint32_t branch_ref);

  float voxels_per_m_;
  KdPool<KdLeaf> leaves_;
  KdPool<KdBranch> branches_;
};

/// The first lane below a heap position (7..14 are the lanes themselves).
inline std::uint32_t first_lane(std::uint32_t heap) {
  while (heap < kKdPlanes) heap = 2 * heap + 1;
  return heap - kKdPlanes;
}

}  // namespace slamd
