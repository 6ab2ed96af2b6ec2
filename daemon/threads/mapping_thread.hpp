#pragma once
// The mapping thread: keyframes and GPS fixes through the back end into the map, poses into the trajectory. Not real-time:
// it may be late, allocates and takes locks, and nothing that it does reaches the estimator.

#include <atomic>
#include <cstdint>
#include <mutex>
#include <stop_token>
#include <utility>

#include "daemon/store/map_store.hpp"
#include "daemon/store/trajectory_store.hpp"
#include "daemon/threads/back_end_state.hpp"
#include "daemon/threads/checkpoint_thread.hpp"
#include "daemon/threads/streams.hpp"
#include "estimator/graph/relocaliser.hpp"

namespace slamd {

class MappingThread {
 public:
  /// Streams and stores must outlive it.
  MappingThread(Relocaliser back_end, Streams& streams, MapStore& map, TrajectoryStore& trajectory)
      : back_end_{std::move(back_end)}, streams_{streams}, map_{map}, trajectory_{trajectory} {}

  /// Before run(): begins with the map of an earlier run, in which the vehicle is looked for. grid  of its packed clouds
  void restore(StoredMap map, const CloudGrid& grid);
  /// Before run(): hands the map over to be kept; must outlive the thread.
  void keep_checkpoints(CheckpointThread& checkpoints) { checkpoints_ = &checkpoints; }

  /// The thread's body: returns soon after a stop request, with the streams empty.
  void run(const std::stop_token& stop);

  /// Any thread. Fixes that carried a position.
  std::uint64_t fixes() const { return fixes_.load(std::memory_order_relaxed); }
  /// Any thread.
  BackEndState state() const {
    const std::lock_guard lock{state_mutex_};
    return state_;
  }

 private:
  void drain();
  void take(const Keyframe& keyframe);
  void solve(const std::stop_token& stop);
  void tell_link();
  void tell_state();
  void make_checkpoint();

  Relocaliser back_end_;
  Streams& streams_;
  MapStore& map_;
  TrajectoryStore& trajectory_;
  MapLink told_link_;
  CheckpointThread* checkpoints_ = nullptr;
  std::size_t kept_keyframes_ = 0;  // in the newest checkpoint
  std::atomic<std::uint64_t> fixes_{0};
  mutable std::mutex state_mutex_;
  BackEndState state_;
};

}  // namespace slamd
