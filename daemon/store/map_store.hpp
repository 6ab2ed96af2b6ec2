#pragma once
// The map as keyframes with thinned points, bounded by a byte budget: what get_map and save_map read. Not the filter's
// map (estimator/map), and it corrects nothing itself: the back end says where keyframes lie.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "daemon/store/geo_reference.hpp"
#include "daemon/store/map_snapshot.hpp"
#include "daemon/store/moving_points.hpp"
#include "daemon/store/packed_point.hpp"
#include "daemon/store/recent_voxels.hpp"
#include "estimator/types/keyframe.hpp"

namespace slamd {

struct MapStoreConfig {
  double voxel_size_m = 0.2;         // one point in each; finer detail is not kept
  std::uint32_t shared_keyframes = 150;  // a surface that one of so many keyframes before has is not stored again
  std::size_t byte_budget = 256U * 1024 * 1024;  // of all keyframes; beyond it the oldest are forgotten
  MovingPointsConfig moving{};
};

/// An axis-aligned box in map, metres; by default everything.
struct MapBox {
  Eigen::Vector3d min_m = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());
  Eigen::Vector3d max_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
};

struct MapQuery {
  MapBox box;
  double voxel_size_m = 0.2;  // > 0; at most one point in each voxel of the result
  std::size_t max_points = 10'000'000;
};

struct MapCounts {
  std::size_t keyframes = 0;
  std::size_t points = 0;
  std::size_t bytes = 0;
  std::size_t byte_budget = 0;
  std::uint64_t changes = 0;              // of what a snapshot shows: keyframes added, moved, thinned or forgotten
  std::uint64_t moved_keyframes = 0;      // by corrections of the back end
  std::uint64_t moving_points = 0;        // removed: rays went through them
  std::uint64_t evicted_keyframes = 0;    // forgotten for the budget; more than none: the map has lost its beginning
  std::uint64_t rejected_keyframes = 0;   // id seen before, or a pose that is not finite
  std::uint64_t rejected_points = 0;      // not finite, or beyond kMaxRange_m of base
};

/// A keyframe's place after a correction.
struct KeyframePose {
  std::uint64_t id = 0;
  Pose T_map_base;
};

/// One thread adds; every other method may be called from any thread. The lock is held for list work only, never while
/// points are computed over. Not for real-time threads.
class MapStore {
 public:
  static constexpr double kMaxRange_m = PackedPoint::kReach_m;

  /// T_base_lidar  where rays come from.
  explicit MapStore(const MapStoreConfig& config = {}, const Pose& T_base_lidar = {});
  ~MapStore();

  /// Adds a keyframe: of its points the first in each voxel, if no recent keyframe has that surface already; then takes
  /// away from recent keyframes what turned out to have moved. Some milliseconds, bounded.
  /// T_map_odom  where odom lies in map at that moment; the keyframe stays at T_map_odom * state.T_odom_base.
  void add(const Keyframe& keyframe, const Pose& T_map_odom = {});

  /// A keyframe of an earlier run, as it is: nothing is thinned. The adding thread, before the first add().
  void restore(std::uint64_t id, const Pose& T_map_base, PackedPoints points);

  /// Forgets everything: a new map begins, whose ids count from 0 again. The adding thread.
  void clear();

  /// Moves keyframes that the pose graph has corrected: one assignment each, unknown ids are ignored.
  void move(std::span<const KeyframePose> poses);

  /// Tells later snapshots where map lies on the earth.
  void set_geo_reference(const std::optional<GeoReference>& reference);
  std::optional<GeoReference> geo_reference() const;

  /// Told the share done, 0..1; returning false ends the work early.
  using Progress = std::function<bool(double)>;

  /// The map's points inside query.box, in map. An interrupted or truncated snapshot holds what was found until then. Large
  /// maps are gone through several times, a share of the voxels each, so that the set of voxels takes some 10 MB.
  MapSnapshot snapshot(const MapQuery& query, const Progress& progress = {}) const;

  MapCounts counts() const;

 private:
  struct StoredKeyframe;
  using Keyframes = std::map<std::uint64_t, StoredKeyframe>;

  std::vector<MapSnapshot::Part> parts_in(const MapBox& box, MapSnapshot& snapshot) const;
  PackedPoints thin(const Keyframe& keyframe);
  bool keep(const Keyframe& keyframe, StoredKeyframe stored);
  std::optional<std::uint64_t> oldest_kept() const;
  void take_away(const MovingPoints::Verdict& verdict);
  void keep_budget();                                                // with the lock held
  void account(const StoredKeyframe& keyframe, bool added);         // likewise

  const MapStoreConfig config_;
  const Pose T_base_lidar_;
  RecentVoxels recent_;    // of the adding thread
  MovingPoints moving_;    // likewise
  mutable std::mutex mutex_;
  Keyframes keyframes_;
  MapCounts counts_;
  std::optional<GeoReference> reference_;
};

}  // namespace slamd
