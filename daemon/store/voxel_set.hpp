#pragma once
// Which voxels of a grid are taken: an open-addressing hash set of fixed room that knows a voxel by 32 bits of its hash
// beside its slot. Keeps no points. Two voxels are taken for one about once in a thousand million.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace slamd {

/// One of `of` shares into which the voxels of all grids fall by chance.
struct VoxelShare {
  std::uint32_t number = 0;
  std::uint32_t of = 1;
};

class VoxelSet {
 public:
  /// voxel_size_m > 0. most: how many voxels will be taken at most, below 2^31. share: the others are never taken.
  VoxelSet(double voxel_size_m, std::size_t most, VoxelShare share = {});

  /// Takes the voxel of a finite point; false when it was taken already or is of another share. The grid repeats itself after 2^21 voxels.
  bool take(double x, double y, double z);

  std::size_t size() const { return size_; }

  /// Spreads neighbouring voxel numbers over a table (the finaliser of splitmix64).
  static std::uint64_t spread(std::uint64_t key) {
    key = (key ^ (key >> 30U)) * 0xBF58476D1CE4E5B9U;
    key = (key ^ (key >> 27U)) * 0x94D049BB133111EBU;
    return key ^ (key >> 31U);
  }

 private:
  double inverse_size_;
  VoxelShare share_;
  std::vector<std::uint32_t> slots_;  // at most four fifths taken; 0 is free
  std::size_t size_ = 0;
};

}  // namespace slamd
