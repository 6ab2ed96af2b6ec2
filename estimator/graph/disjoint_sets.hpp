#pragma once
// Union-find with path halving: which of so many things are joined. Sets are never parted again.

#include <cstddef>
#include <numeric>
#include <vector>

namespace slamd {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }

  /// The same for all that are joined.
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[root(a)] = root(b); }

  /// Of each thing's set.
  std::vector<std::size_t> sizes() {
    std::vector<std::size_t> of_root(parent_.size(), 0), sizes;
    for (std::size_t i = 0; i < parent_.size(); ++i) ++of_root[root(i)];
    for (std::size_t i = 0; i < parent_.size(); ++i) sizes.push_back(of_root[root(i)]);
    return sizes;
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace slamd
