#pragma once
// Which voxels of odom recent keyframes hold a point in, so that the next keyframe does not store the same surface again.
// Not the map: it forgets a keyframe after `window` others, and a later pass over the same place stores its own points.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace slamd {

class RecentVoxels {
 public:
  /// voxel_size_m > 0; 0 < window < 2^23 keyframes.
  RecentVoxels(double voxel_size_m, std::uint32_t window);

  /// Keyframe number `serial` (counting up) takes the voxel of a finite point; false when one of the `window` keyframes up
  /// to this one has it. The grid repeats itself after 2^14 voxels in x and y, 2^12 in z.
  bool take(const Eigen::Vector3d& p_odom, std::uint32_t serial);

  /// The keyframes before `serial` are gone, and their voxels free.
  void forget_before(std::uint32_t serial) { oldest_ = serial; }

  /// The voxel is free again, if keyframe `serial` has it.
  void release(const Eigen::Vector3d& p_odom, std::uint32_t serial);

  std::size_t bytes() const { return slots_.size() * sizeof(std::uint64_t); }

 private:
  std::uint64_t key(const Eigen::Vector3d& p_odom) const;
  std::size_t find(std::uint64_t key) const;
  bool is_recent(std::uint64_t slot) const;
  void forget_old();

  double inverse_size_;
  std::uint32_t window_;
  std::uint32_t newest_ = 0, oldest_ = 0;
  std::vector<std::uint64_t> slots_;  // key above, serial in the low 24 bits
  std::size_t used_ = 0;              // slots that are not free, old ones included
};

}  // namespace slamd
