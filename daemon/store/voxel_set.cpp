#include "daemon/store/voxel_set.hpp"

#include <algorithm>
#include <bit>
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

VoxelSet::VoxelSet(double voxel_size_m, std::size_t most)
    : inverse_size_{1.0 / voxel_size_m}, slots_(std::bit_ceil(std::max(most / 3 * 4 + 4, kFewestSlots)), 0) {}

bool VoxelSet::take(double x, double y, double z) {
  const std::uint64_t hash = spread(axis_number(x * inverse_size_) << 42U | axis_number(y * inverse_size_) << 21U |
                                    axis_number(z * inverse_size_));
  const std::uint32_t mark = static_cast<std::uint32_t>(hash >> 32U) | 1U;
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hash & mask;
  while (slots_[slot] != 0) {
    if (slots_[slot] == mark) return false;
    slot = (slot + 1) & mask;
  }
  slots_[slot] = mark;
  ++size_;
  assert(size_ < slots_.size());
  return true;
}

}  // namespace slamd
