#pragma once
// The mapping thread of planar mode: keyframes through the planar back end into the occupancy grid and the checkpoint, poses
// into the trajectory. Not real-time: it may be late, and nothing that it does reaches the estimator.

#include <cstdint>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stop_token>

#include "daemon/store/grid_store.hpp"
#include "daemon/store/trajectory_store.hpp"
#include "daemon/threads/grid_maker.hpp"
#include "daemon/threads/planar_keeper.hpp"
#include "daemon/threads/streams.hpp"
#include "estimator/graph/relocaliser.hpp"
#include "estimator/grid/planar_relocaliser.hpp"
#include "estimator/grid/slam_2d.hpp"

namespace slamd {

/// What get_status says of the planar back end.
struct PlanarState {
  std::uint64_t keyframes = 0;
  std::uint64_t closures = 0;
  PlanarPose T_map_odom;
  bool relocalising = false;
  RelocaliserCounts relocalisation;
  std::uint64_t grid_keyframes = 0;  // that the newest grid shows
  double grid_s = 0.0;               // that its snapshot took
  CheckpointReport checkpoint;
};
nlohmann::json to_json(const PlanarState& state);

class PlanarMappingThread {
 public:
  /// Streams and stores must outlive it.
  PlanarMappingThread(const Slam2dConfig& config, PlanarKeeper keeper, Streams& streams, GridStore& grid, TrajectoryStore& trajectory);

  /// Before run(): begins with the map of an earlier run, in which the vehicle is looked for near its end.
  void restore(const StoredPlanarMap& map);

  /// The thread's body: returns soon after a stop request, with the streams empty and the map kept.
  void run(const std::stop_token& stop);

  /// Any thread.
  PlanarState state() const {
    const std::lock_guard lock{state_mutex_};
    return state_;
  }

 private:
  void drain();
  void take(const PlanarKeyframe& keyframe);
  PlanarPose believed(const PlanarKeyframe& keyframe) const;
  void link(const PlanarPose& T_chain_odom);
  void enter(PlanarKeyframe keyframe);
  void work(const std::stop_token& stop);
  void tell_link();
  void make_grid();
  void tell_state();

  Slam2dConfig config_;
  PlanarMapper mapper_;
  GridMaker maker_;
  PlanarKeeper keeper_;
  std::optional<PlanarRelocaliser> search_;  // while the vehicle is looked for in the map of before
  StoredPlanarMap left_;                     // its last two keyframes
  std::vector<PlanarKeyframe> waiting_;      // that came meanwhile
  PlanarPose T_chain_odom_;                  // the chain of the mapper's keyframes goes on where the map of before ended
  std::uint64_t entered_ = 0;
  RelocaliserCounts relocalisation_;
  Streams& streams_;
  GridStore& grid_;
  TrajectoryStore& trajectory_;
  MapLink told_link_;
  HostTime next_grid_;
  std::uint64_t grid_keyframes_ = 0;
  double grid_s_ = 0.0;
  mutable std::mutex state_mutex_;
  PlanarState state_;
};

}  // namespace slamd
