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
#include <span>
#include <vector>

#include "estimator/types/keyframe.hpp"
#include "estimator/types/pose.hpp"

namespace slamd {

struct MapStoreConfig {
  double voxel_size_m = 0.2;                     // of each keyframe; finer detail is not kept
  std::size_t byte_budget = 256U * 1024 * 1024;  // of all points; beyond it the oldest keyframes are forgotten
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

struct MapSnapshot {
  PointCloud points;          // map frame, ordered by keyframe
  std::size_t keyframes = 0;  // that were read
  bool truncated = false;     // max_points was reached
};

struct MapCounts {
  std::size_t keyframes = 0;
  std::size_t points = 0;
  std::size_t bytes = 0;
  std::uint64_t evicted_keyframes = 0;   // forgotten for the budget
  std::uint64_t rejected_keyframes = 0;   // id seen before, or a pose that is not finite
  std::uint64_t rejected_points = 0;      // not finite, or beyond kMaxRange_m of base
};

/// A keyframe's place after a correction.
struct KeyframePose {
  std::uint64_t id = 0;
  Pose T_map_base;
};

/// Every method may be called from any thread; the lock is held for list work only, never while points are computed
/// over. Not for real-time threads.
class MapStore {
 public:
  static constexpr double kMaxRange_m = 160.0;

  explicit MapStore(const MapStoreConfig& config = {});
  ~MapStore();

  /// Adds a keyframe's points (base frame, metres), thinned to the first one in each voxel.
  /// T_map_odom  where odom lies in map at that moment; the keyframe stays at T_map_odom * state.T_odom_base.
  void add(const Keyframe& keyframe, const Pose& T_map_odom = {});

  /// Moves keyframes that the pose graph has corrected; unknown ids are ignored.
  void move(std::span<const KeyframePose> poses);

  /// Told the share done, 0..1; returning false ends the work early.
  using Progress = std::function<bool(double)>;

  /// The map's points inside query.box, in map. An interrupted or truncated snapshot holds what was found until then.
  MapSnapshot snapshot(const MapQuery& query, const Progress& progress = {}) const;

  MapCounts counts() const;
  void clear();

 private:
  struct StoredKeyframe;
  using Keyframes = std::map<std::uint64_t, StoredKeyframe>;

  void keep_budget();  // with the lock held

  const MapStoreConfig config_;
  mutable std::mutex mutex_;
  Keyframes keyframes_;
  MapCounts counts_;
};

}  // namespace slamd
