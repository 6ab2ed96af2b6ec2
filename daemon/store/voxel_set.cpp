#include "daemon/store/voxel_set.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace slamd {
namespace {

constexpr std::uint64_t kAxisMask = (std::uint64_t{1} << 21U) - 1;
constexpr std::size_t kFewestSlots = 64;

std::uint64_t axis_number(double coordinate) {
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(coordinate))) & kAxisMask;
}

}  // namespace

VoxelSet::VoxelSet(double voxel_size_m, std::size_t most, VoxelShare share)
    : inverse_size_{1.0 / voxel_size_m}, share_{share}, slots_(std::max(most / 4 * 5 + 4, kFewestSlots), 0) {}

bool VoxelSet::take(double x, double y, double z) {
  const std::uint64_t hash = spread(axis_number(x * inverse_size_) << 42U | axis_number(y * inverse_size_) << 21U |
                                    axis_number(z * inverse_size_));
  if (static_cast<std::uint32_t>(hash >> 1U) % share_.of != share_.number) return false;
  const std::uint32_t mark = static_cast<std::uint32_t>(hash) | 1U;
  std::size_t slot = ((hash >> 32U) * slots_.size()) >> 32U;  // the high half, from 2^32 down to their number
  while (slots_[slot] != 0) {
    if (slots_[slot] == mark) return false;
    slot = slot + 1 < slots_.size() ? slot + 1 : 0;
  }
  slots_[slot] = mark;
  ++size_;
  assert(size_ < slots_.size());
  return true;
}

}  // namespace slamd
