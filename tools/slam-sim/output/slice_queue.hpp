#pragma once
// Runs a Simulation ahead of time in its own thread. Bounded: the generator waits when it is `capacity` slices ahead.

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

#include "tools/slam-sim/sensors/simulation.hpp"

namespace slamd::sim {

class SliceQueue {
 public:
  SliceQueue(Simulation& simulation, std::size_t capacity);
  /// Stops the generator after the slice it is at.
  ~SliceQueue() = default;

  /// Blocks until `count` slices are ready or the drive is generated to its end.
  void wait_for(std::size_t count);
  /// The next slice in order; nothing when the drive is over. Blocks while the generator is behind.
  std::optional<std::vector<WireEvent>> pop();

 private:
  void generate(const std::stop_token& stop);

  Simulation& simulation_;
  std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<std::vector<WireEvent>> slices_;
  bool finished_ = false;
  std::jthread generator_;  // last: it uses the members above
};

}  // namespace slamd::sim
