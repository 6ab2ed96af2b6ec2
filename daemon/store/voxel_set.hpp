#pragma once
// Which voxels of a grid are taken: an open-addressing hash set of 63-bit voxel numbers. Keeps no points.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace slamd {

class VoxelSet {
 public:
  /// voxel_size_m > 0. expected: how many voxels it should hold before it first has to grow.
  VoxelSet(double voxel_size_m, std::size_t expected);

  /// Takes the voxel of a finite point; false when it was taken already. The grid repeats itself after 2^21 voxels.
  bool take(double x, double y, double z) { return insert(key(x, y, z)); }

  std::size_t size() const { return size_; }

  /// Spreads neighbouring voxel numbers over a table (the finaliser of splitmix64).
  static std::size_t spread(std::uint64_t key) {
    key = (key ^ (key >> 30U)) * 0xBF58476D1CE4E5B9U;
    key = (key ^ (key >> 27U)) * 0x94D049BB133111EBU;
    return static_cast<std::size_t>(key ^ (key >> 31U));
  }

 private:
  static constexpr std::uint64_t kFree = ~std::uint64_t{0};  // no key: those have 63 bits

  std::uint64_t key(double x, double y, double z) const;
  bool insert(std::uint64_t key);
  void grow();

  double inverse_size_;
  std::vector<std::uint64_t> slots_;  // power of two
  std::size_t size_ = 0;
};

}  // namespace slamd
