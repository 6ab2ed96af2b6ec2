#include "daemon/store/map_store.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "daemon/store/voxel_set.hpp"

namespace slamd {
namespace {

bool is_finite(const Pose& pose) {
  return pose.translation.allFinite() && pose.rotation.coeffs().allFinite();
}

bool is_same(const Pose& a, const Pose& b) {
  return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
}

bool contains(const MapBox& box, const Eigen::Vector3d& p_map) {
  return (p_map.array() >= box.min_m.array()).all() && (p_map.array() <= box.max_m.array()).all();
}

/// Can any point within reach_m of this place lie in the box?
bool may_touch(const MapBox& box, const Eigen::Vector3d& p_map, double reach_m) {
  return ((p_map.array() + reach_m) >= box.min_m.array()).all() &&
         ((p_map.array() - reach_m) <= box.max_m.array()).all();
}

double reach_of(const PackedPoints& points) {
  float reach2 = 0.0F;
  for (const PackedPoint& point : points) reach2 = std::max(reach2, point.position().squaredNorm());
  return std::sqrt(reach2);
}

}  // namespace

struct MapStore::StoredKeyframe {
  Pose T_map_base;
  double reach_m = 0.0;                        // of the farthest point from base
  std::shared_ptr<const PackedPoints> points;  // shared: a snapshot outlives an eviction

  std::size_t bytes() const {
    constexpr std::size_t kListNode = 48;  // of the map and of the pointer's count
    return points->size() * sizeof(PackedPoint) + sizeof(StoredKeyframe) + sizeof(PackedPoints) + 2 * kListNode;
  }
};

namespace {

constexpr std::size_t kPointsAPass = 2'000'000;
constexpr std::size_t kMostPasses = 8;

/// Chooses what lies in the box and in a voxel not yet taken, `room` points at most. False: there were more.
bool choose(const MapBox& box, VoxelSet& voxels, std::size_t& room, MapSnapshot::Part& part) {
  for (std::size_t i = 0; i < part.points->size(); ++i) {
    const Eigen::Vector3d p_map = part.T_map_base * (*part.points)[i].position().cast<double>();
    if (!contains(box, p_map) || !voxels.take(p_map.x(), p_map.y(), p_map.z())) continue;
    if (room == 0) return false;
    part.chosen[i] = true;
    --room;
  }
  return true;
}

}  // namespace

MapStore::MapStore(const MapStoreConfig& config, const Pose& T_base_lidar)
    : config_{config},
      T_base_lidar_{T_base_lidar},
      recent_{config.voxel_size_m, config.shared_keyframes},
      moving_{config.moving, T_base_lidar} {
  counts_.byte_budget = config.byte_budget;
}
MapStore::~MapStore() = default;

void MapStore::add(const Keyframe& keyframe, const Pose& T_map_odom) {
  const Pose T_map_base = T_map_odom * keyframe.state.T_odom_base;
  PackedPoints points;
  if (is_finite(T_map_base)) points = thin(keyframe);
  const auto shared = std::make_shared<const PackedPoints>(std::move(points));
  if (!keep(keyframe, {T_map_base, reach_of(*shared), shared})) return;
  recent_.forget_before(static_cast<std::uint32_t>(oldest_kept().value_or(keyframe.id + 1)));
  for (const MovingPoints::Verdict& verdict : moving_.add(keyframe, *shared)) take_away(verdict);
}

/// The first point of each voxel of odom that no recent keyframe has taken.
PackedPoints MapStore::thin(const Keyframe& keyframe) {
  PackedPoints points;
  std::size_t rejected = 0;
  for (const CloudPoint& point : keyframe.points) {
    const std::optional<PackedPoint> packed = PackedPoint::of(point);
    if (!packed) {
      ++rejected;
    } else if (recent_.take(keyframe.state.T_odom_base * Eigen::Vector3d{point.x, point.y, point.z},
                            static_cast<std::uint32_t>(keyframe.id))) {
      points.push_back(*packed);
    }
  }
  points.shrink_to_fit();
  const std::lock_guard lock{mutex_};
  counts_.rejected_points += rejected;
  return points;
}

bool MapStore::keep(const Keyframe& keyframe, StoredKeyframe stored) {
  const std::lock_guard lock{mutex_};
  const auto [place, is_new] = is_finite(stored.T_map_base) ? keyframes_.emplace(keyframe.id, std::move(stored))
                                                            : std::pair{keyframes_.end(), false};
  if (!is_new) {
    ++counts_.rejected_keyframes;
    return false;
  }
  account(place->second, true);
  ++counts_.changes;
  keep_budget();
  return true;
}

std::optional<std::uint64_t> MapStore::oldest_kept() const {
  const std::lock_guard lock{mutex_};
  return keyframes_.empty() ? std::nullopt : std::optional{keyframes_.begin()->first};
}

void MapStore::take_away(const MovingPoints::Verdict& verdict) {
  for (const PackedPoint& point : verdict.removed) {
    recent_.release(verdict.T_odom_base * point.position().cast<double>(), static_cast<std::uint32_t>(verdict.id));
  }
  auto kept = std::make_shared<const PackedPoints>(verdict.kept);
  const std::lock_guard lock{mutex_};
  const auto found = keyframes_.find(verdict.id);
  if (found == keyframes_.end()) return;
  account(found->second, false);
  found->second.points = std::move(kept);
  account(found->second, true);
  counts_.moving_points += verdict.removed.size();
  ++counts_.changes;
}

void MapStore::account(const StoredKeyframe& keyframe, bool added) {
  const auto add = [added](std::size_t& total, std::size_t share) { total = added ? total + share : total - share; };
  add(counts_.points, keyframe.points->size());
  add(counts_.bytes, keyframe.bytes());
}

void MapStore::keep_budget() {
  while (counts_.bytes > config_.byte_budget && !keyframes_.empty()) {
    const auto oldest = keyframes_.begin();
    account(oldest->second, false);
    ++counts_.evicted_keyframes;
    ++counts_.changes;
    keyframes_.erase(oldest);
  }
}

void MapStore::restore(std::uint64_t id, const Pose& T_map_base, PackedPoints points) {
  Keyframe keyframe;
  keyframe.id = id;
  const auto shared = std::make_shared<const PackedPoints>(std::move(points));
  keep(keyframe, {T_map_base, reach_of(*shared), shared});
}

void MapStore::clear() {
  recent_ = RecentVoxels{config_.voxel_size_m, config_.shared_keyframes};
  moving_ = MovingPoints{config_.moving, T_base_lidar_};
  const std::lock_guard lock{mutex_};
  while (!keyframes_.empty()) {
    account(keyframes_.begin()->second, false);
    keyframes_.erase(keyframes_.begin());
  }
  reference_.reset();
  ++counts_.changes;
}

void MapStore::move(std::span<const KeyframePose> poses) {
  const std::lock_guard lock{mutex_};
  std::uint64_t moved = 0;
  for (const KeyframePose& pose : poses) {
    const auto found = keyframes_.find(pose.id);
    if (found == keyframes_.end() || !is_finite(pose.T_map_base)) continue;
    if (is_same(found->second.T_map_base, pose.T_map_base)) continue;
    found->second.T_map_base = pose.T_map_base;
    ++moved;
  }
  counts_.moved_keyframes += moved;
  if (moved > 0) ++counts_.changes;
}

void MapStore::set_geo_reference(const std::optional<GeoReference>& reference) {
  const std::lock_guard lock{mutex_};
  reference_ = reference;
}

std::optional<GeoReference> MapStore::geo_reference() const {
  const std::lock_guard lock{mutex_};
  return reference_;
}

/// The keyframes that may have points in the box, nothing chosen yet.
std::vector<MapSnapshot::Part> MapStore::parts_in(const MapBox& box, MapSnapshot& snapshot) const {
  std::vector<MapSnapshot::Part> parts;
  const std::lock_guard lock{mutex_};
  snapshot.reference = reference_;
  for (const auto& [id, keyframe] : keyframes_) {
    if (may_touch(box, keyframe.T_map_base.translation, keyframe.reach_m)) parts.push_back({keyframe.T_map_base, keyframe.points, {}, 0});
  }
  return parts;
}

MapSnapshot MapStore::snapshot(const MapQuery& query, const Progress& progress) const {
  MapSnapshot snapshot;
  std::vector<MapSnapshot::Part> parts = parts_in(query.box, snapshot);
  std::size_t most = 0;
  for (MapSnapshot::Part& part : parts) {
    part.chosen.assign(part.points->size(), false);
    most += part.points->size();
  }
  const std::size_t passes = std::min(most / kPointsAPass + 1, kMostPasses);
  const std::size_t steps = passes * parts.size();
  std::size_t room = query.max_points;
  std::optional<VoxelSet> voxels;
  for (std::size_t step = 0; step < steps && !snapshot.truncated; ++step) {
    if (progress && !progress(static_cast<double>(step) / static_cast<double>(steps))) break;
    const auto pass = static_cast<std::uint32_t>(step / parts.size());
    const std::size_t share = passes == 1 ? most : most / passes / 8 * 9;  // more than chance makes of so many
    if (step % parts.size() == 0) voxels.emplace(query.voxel_size_m, share, VoxelShare{pass, static_cast<std::uint32_t>(passes)});
    snapshot.truncated = !choose(query.box, *voxels, room, parts[step % parts.size()]);
    if (pass == 0) ++snapshot.keyframes;
  }
  for (MapSnapshot::Part& part : parts) snapshot.append(std::move(part));
  return snapshot;
}

MapCounts MapStore::counts() const {
  const std::lock_guard lock{mutex_};
  MapCounts counts = counts_;
  counts.keyframes = keyframes_.size();
  return counts;
}

}  // namespace slamd
