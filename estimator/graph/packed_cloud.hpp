#pragma once
// A keyframe's points, one a voxel, in three to four bytes each: for sub-maps that are put together much later. Not the
// map's points (daemon/store), which are finer and can be read singly.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "estimator/types/point_cloud.hpp"

namespace slamd {

/// The grid about the keyframe's base.
struct CloudGrid {
  float voxel_size_m = 0.5F;
  float max_range_m = 60.0F;  // 2 * max_range_m / voxel_size_m at most 1,600

  int cells() const { return static_cast<int>(2.0F * max_range_m / voxel_size_m) + 2; }  // along an axis
};

/// Of the points (base frame, metres) within reach the first in each voxel, ordered by voxel: how many voxels on from the one
/// before (7 bits a byte, the highest says that more follow), then the place inside: 5, 5 and 6 bits of x, y, z.
std::vector<std::uint8_t> pack_cloud(std::span<const CloudPoint> points_base, const CloudGrid& grid);

/// Whether unpack_cloud can read it: for bytes that come from outside.
bool is_packed_cloud(std::span<const std::uint8_t> bytes);

/// Calls take(point) for each, base frame, metres; at most 1/64 of a voxel off in x and y, 1/128 in z.
void unpack_cloud(std::span<const std::uint8_t> packed, const CloudGrid& grid,
                  const std::function<void(const Eigen::Vector3f&)>& take);

}  // namespace slamd
