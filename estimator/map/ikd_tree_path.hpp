#pragma once
// The way from the root to a leaf, shared by the source files of IkdTree. Not for others.

#include <array>
#include <cstdint>

#include "estimator/map/ikd_tree.hpp"

namespace slamd {

/// Insertion stops at kMaxDepth; dividing subtrees may make the tree a little deeper for a while.
inline constexpr std::uint32_t kPathCapacity = IkdTree::kMaxDepth + 16;
inline constexpr std::size_t kMaxDetached = 4096;
inline constexpr std::size_t kMaxAgenda = 256;

struct IkdTree::Path {
  struct Step {
    std::uint32_t branch;
    std::uint32_t lane;
  };
  std::array<Step, kPathCapacity> steps;
  std::uint32_t length = 0;
  std::uint32_t end = kNoNode;  // leaf, or kNoNode when the lane is empty
};

}  // namespace slamd
