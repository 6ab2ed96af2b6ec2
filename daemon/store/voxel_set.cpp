#include "daemon/store/voxel_set.hpp"

#include <algorithm>
#include <bit>

namespace slamd {
namespace {

constexpr std::uint64_t kAxisMask = (std::uint64_t{1} << 21U) - 1;
constexpr std::size_t kFewestSlots = 64;

std::uint64_t axis_number(double coordinate) {
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(coordinate))) & kAxisMask;
}

}  // namespace

VoxelSet::VoxelSet(double voxel_size_m, std::size_t expected)
    : inverse_size_{1.0 / voxel_size_m}, slots_(std::bit_ceil(std::max(2 * expected, kFewestSlots)), kFree) {}

std::uint64_t VoxelSet::key(double x, double y, double z) const {
  return axis_number(x * inverse_size_) << 42U | axis_number(y * inverse_size_) << 21U |
         axis_number(z * inverse_size_);
}

bool VoxelSet::insert(std::uint64_t key) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = spread(key) & mask;
  while (slots_[slot] != kFree) {
    if (slots_[slot] == key) return false;
    slot = (slot + 1) & mask;
  }
  slots_[slot] = key;
  if (++size_ * 4 > slots_.size() * 3) grow();
  return true;
}

void VoxelSet::grow() {
  std::vector<std::uint64_t> old(slots_.size() * 2, kFree);
  old.swap(slots_);
  size_ = 0;
  for (const std::uint64_t key : old) {
    if (key != kFree) insert(key);
  }
}

}  // namespace slamd
