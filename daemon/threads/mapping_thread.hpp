#pragma once
// The mapping thread: keyframes into the map, poses into the trajectory, GPS fixes counted. Not real-time: it may be
// late, allocates and takes locks, and nothing that it does reaches the estimator.

#include <atomic>
#include <cstdint>
#include <stop_token>

#include "daemon/store/map_store.hpp"
#include "daemon/store/trajectory_store.hpp"
#include "daemon/threads/streams.hpp"

namespace slamd {

class MappingThread {
 public:
  /// All must outlive it.
  MappingThread(Streams& streams, MapStore& map, TrajectoryStore& trajectory)
      : streams_{streams}, map_{map}, trajectory_{trajectory} {}

  /// The thread's body: returns soon after a stop request, with the streams empty.
  void run(const std::stop_token& stop);

  /// Any thread. Fixes that carried a position.
  std::uint64_t fixes() const { return fixes_.load(std::memory_order_relaxed); }

 private:
  void drain();

  Streams& streams_;
  MapStore& map_;
  TrajectoryStore& trajectory_;
  std::atomic<std::uint64_t> fixes_{0};
};

}  // namespace slamd
