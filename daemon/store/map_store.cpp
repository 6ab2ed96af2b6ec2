#include "daemon/store/map_store.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "daemon/store/voxel_set.hpp"

namespace slamd {
namespace {

constexpr double kUnit_m = 0.005;  // 16 bits of it reach 163.8 m, beyond kMaxRange_m; worst rounding 2.5 mm an axis
static_assert(MapStore::kMaxRange_m / kUnit_m < 32767);

struct PackedPoint {
  std::int16_t x, y, z;  // base frame, in kUnit_m
  std::uint16_t intensity;
};
using PackedPoints = std::vector<PackedPoint>;

bool is_finite(const Pose& pose) {
  return pose.translation.allFinite() && pose.rotation.coeffs().allFinite();
}

std::optional<PackedPoint> pack(const CloudPoint& point) {
  const auto fits = [](float coordinate) { return std::abs(coordinate) <= MapStore::kMaxRange_m; };  // NaN does not
  if (!fits(point.x) || !fits(point.y) || !fits(point.z)) return std::nullopt;
  const auto units = [](float coordinate) { return static_cast<std::int16_t>(std::lround(coordinate / kUnit_m)); };
  const float intensity = std::isfinite(point.intensity) ? std::clamp(point.intensity, 0.0F, 255.0F) : 0.0F;
  return PackedPoint{units(point.x), units(point.y), units(point.z), static_cast<std::uint16_t>(intensity)};
}

Eigen::Vector3d unpack(const PackedPoint& point) {
  return Eigen::Vector3d{static_cast<double>(point.x), static_cast<double>(point.y), static_cast<double>(point.z)} *
         kUnit_m;
}

bool contains(const MapBox& box, const Eigen::Vector3d& p_map) {
  return (p_map.array() >= box.min_m.array()).all() && (p_map.array() <= box.max_m.array()).all();
}

/// Can any point within kMaxRange_m (each axis) of this place lie in the box?
bool may_touch(const MapBox& box, const Eigen::Vector3d& p_map) {
  const double reach_m = MapStore::kMaxRange_m * std::sqrt(3.0);
  return ((p_map.array() + reach_m) >= box.min_m.array()).all() &&
         ((p_map.array() - reach_m) <= box.max_m.array()).all();
}

struct PlacedPoints {
  std::shared_ptr<const PackedPoints> points;
  Pose T_map_base;
};

/// Appends what lies in the box and in a voxel not yet taken. False when max_points was reached.
bool append(const PlacedPoints& placed, const MapQuery& query, VoxelSet& voxels, PointCloud& out) {
  for (const PackedPoint& point : *placed.points) {
    const Eigen::Vector3d p_map = placed.T_map_base * unpack(point);
    if (!contains(query.box, p_map) || !voxels.take(p_map.x(), p_map.y(), p_map.z())) continue;
    if (out.size() == query.max_points) return false;
    out.push_back({static_cast<float>(p_map.x()), static_cast<float>(p_map.y()), static_cast<float>(p_map.z()),
                   static_cast<float>(point.intensity)});
  }
  return true;
}

}  // namespace

struct MapStore::StoredKeyframe {
  Pose T_map_base;
  std::shared_ptr<const PackedPoints> points;  // shared: a snapshot outlives an eviction

  std::size_t bytes() const { return points->size() * sizeof(PackedPoint); }
};

MapStore::MapStore(const MapStoreConfig& config) : config_{config} {}
MapStore::~MapStore() = default;

void MapStore::add(const Keyframe& keyframe, const Pose& T_map_odom) {
  auto points = std::make_shared<PackedPoints>();
  VoxelSet voxels{config_.voxel_size_m, keyframe.points.size()};
  std::size_t rejected = 0;
  for (const CloudPoint& point : keyframe.points) {
    const std::optional<PackedPoint> packed = pack(point);
    if (!packed) ++rejected;
    if (packed && voxels.take(point.x, point.y, point.z)) points->push_back(*packed);
  }
  points->shrink_to_fit();
  const StoredKeyframe stored{T_map_odom * keyframe.state.T_odom_base, std::move(points)};

  const std::lock_guard lock{mutex_};
  counts_.rejected_points += rejected;
  if (!is_finite(stored.T_map_base) || !keyframes_.emplace(keyframe.id, stored).second) {
    ++counts_.rejected_keyframes;
    return;
  }
  counts_.points += stored.points->size();
  counts_.bytes += stored.bytes();
  keep_budget();
}

void MapStore::keep_budget() {
  while (counts_.bytes > config_.byte_budget && !keyframes_.empty()) {
    const auto oldest = keyframes_.begin();
    counts_.points -= oldest->second.points->size();
    counts_.bytes -= oldest->second.bytes();
    ++counts_.evicted_keyframes;
    keyframes_.erase(oldest);
  }
}

void MapStore::move(std::span<const KeyframePose> poses) {
  const std::lock_guard lock{mutex_};
  for (const KeyframePose& pose : poses) {
    const auto found = keyframes_.find(pose.id);
    if (found != keyframes_.end() && is_finite(pose.T_map_base)) found->second.T_map_base = pose.T_map_base;
  }
}

MapSnapshot MapStore::snapshot(const MapQuery& query, const Progress& progress) const {
  std::vector<PlacedPoints> placed;
  {
    const std::lock_guard lock{mutex_};
    placed.reserve(keyframes_.size());
    for (const auto& [id, keyframe] : keyframes_) placed.push_back({keyframe.points, keyframe.T_map_base});
  }
  MapSnapshot snapshot;
  VoxelSet voxels{query.voxel_size_m, 0};
  for (std::size_t i = 0; i < placed.size() && !snapshot.truncated; ++i) {
    if (progress && !progress(static_cast<double>(i) / static_cast<double>(placed.size()))) break;
    if (!may_touch(query.box, placed[i].T_map_base.translation)) continue;
    snapshot.truncated = !append(placed[i], query, voxels, snapshot.points);
    ++snapshot.keyframes;
  }
  return snapshot;
}

MapCounts MapStore::counts() const {
  const std::lock_guard lock{mutex_};
  MapCounts counts = counts_;
  counts.keyframes = keyframes_.size();
  return counts;
}

void MapStore::clear() {
  const std::lock_guard lock{mutex_};
  keyframes_.clear();
  counts_.points = 0;
  counts_.bytes = 0;
}

}  // namespace slamd
