#pragma once
// Bounding volume hierarchy over the static bodies: exact nearest hit of a ray. Read-only after construction.

#include <cstdint>
#include <vector>

#include "tools/slam-sim/world/primitive.hpp"

namespace slamd::sim {

class Bvh {
 public:
  explicit Bvh(std::vector<Primitive> bodies);

  /// Shortens `hit` to the nearest body along the ray. Thread-safe; the result is that of testing every body.
  void cast(const Ray& ray, Hit& hit) const;
  const std::vector<Primitive>& bodies() const { return bodies_; }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first =
        0;  // of its bodies (leaf) or index of the right child (inner; the left child follows the node)
    std::uint32_t count = 0;  // 0 = inner
  };

  void build(std::uint32_t first, std::uint32_t count);
  std::uint32_t partition(std::uint32_t first, std::uint32_t count);

  std::vector<Primitive> bodies_;
  std::vector<Node> nodes_;
};

}  // namespace slamd::sim
