#include "daemon/store/recent_voxels.hpp"

#include <algorithm>
#include <cmath>

#include "daemon/store/voxel_set.hpp"

namespace slamd {
namespace {

constexpr unsigned kSerialBits = 24, kZBits = 12, kXyBits = 14;
constexpr std::uint32_t kSerialMask = (1U << kSerialBits) - 1;
constexpr std::uint64_t kFree = ~std::uint64_t{0};  // no slot in use: its key would be in the highest voxel of all
constexpr std::size_t kFewestSlots = 1024;

std::uint64_t axis(double coordinate, unsigned bits) {
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(coordinate))) & ((std::uint64_t{1} << bits) - 1);
}

}  // namespace

RecentVoxels::RecentVoxels(double voxel_size_m, std::uint32_t window)
    : inverse_size_{1.0 / voxel_size_m}, window_{window}, slots_(kFewestSlots, kFree) {}

std::uint64_t RecentVoxels::key(const Eigen::Vector3d& p_odom) const {
  const Eigen::Vector3d voxel = p_odom * inverse_size_;
  return axis(voxel.x(), kXyBits) << (kXyBits + kZBits) | axis(voxel.y(), kXyBits) << kZBits | axis(voxel.z(), kZBits);
}

std::size_t RecentVoxels::find(std::uint64_t key) const {
  std::size_t slot = ((VoxelSet::spread(key) >> 32U) * slots_.size()) >> 32U;  // from 2^32 down to their number
  while (slots_[slot] != kFree && slots_[slot] >> kSerialBits != key) slot = slot + 1 < slots_.size() ? slot + 1 : 0;
  return slot;
}

bool RecentVoxels::is_recent(std::uint64_t slot) const {
  return ((newest_ - static_cast<std::uint32_t>(slot)) & kSerialMask) < std::min(window_, newest_ - oldest_ + 1);
}

bool RecentVoxels::take(const Eigen::Vector3d& p_odom, std::uint32_t serial) {
  newest_ = serial;
  const std::uint64_t wanted = key(p_odom);
  std::uint64_t& slot = slots_[find(wanted)];
  const bool is_new = slot == kFree;
  if (!is_new && is_recent(slot)) return false;
  slot = wanted << kSerialBits | (serial & kSerialMask);
  if (is_new && ++used_ * 3 > slots_.size() * 2) forget_old();
  return true;
}

void RecentVoxels::release(const Eigen::Vector3d& p_odom, std::uint32_t serial) {
  std::uint64_t& slot = slots_[find(key(p_odom))];
  if (slot == kFree || (slot & kSerialMask) != (serial & kSerialMask)) return;
  slot = (slot & ~std::uint64_t{kSerialMask}) | ((newest_ - window_) & kSerialMask);  // old, as if long ago
}

void RecentVoxels::forget_old() {
  std::vector<std::uint64_t> old;
  old.swap(slots_);
  const auto keep = [this](std::uint64_t slot) { return slot != kFree && is_recent(slot); };
  used_ = static_cast<std::size_t>(std::count_if(old.begin(), old.end(), keep));
  slots_.assign(std::max(2 * used_, kFewestSlots), kFree);
  for (const std::uint64_t slot : old) {
    if (keep(slot)) slots_[find(slot >> kSerialBits)] = slot;
  }
}

}  // namespace slamd
