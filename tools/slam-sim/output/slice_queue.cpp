#include "tools/slam-sim/output/slice_queue.hpp"

namespace slamd::sim {

SliceQueue::SliceQueue(Simulation& simulation, std::size_t capacity)
    : simulation_{simulation}, capacity_{capacity}, generator_{[this](const std::stop_token& stop) {
        generate(stop);
      }} {}

void SliceQueue::generate(const std::stop_token& stop) {
  while (!simulation_.done() && !stop.stop_requested()) {
    std::vector<WireEvent> slice = simulation_.next_slice();
    std::unique_lock lock{mutex_};
    if (!changed_.wait(lock, stop, [&] { return slices_.size() < capacity_; })) break;
    slices_.push_back(std::move(slice));
    changed_.notify_all();
  }
  const std::lock_guard lock{mutex_};
  finished_ = true;
  changed_.notify_all();
}

void SliceQueue::wait_for(std::size_t count) {
  std::unique_lock lock{mutex_};
  changed_.wait(lock, [&] { return finished_ || slices_.size() >= std::min(count, capacity_); });
}

std::optional<std::vector<WireEvent>> SliceQueue::pop() {
  std::unique_lock lock{mutex_};
  changed_.wait(lock, [&] { return finished_ || !slices_.empty(); });
  if (slices_.empty()) return std::nullopt;
  std::vector<WireEvent> slice = std::move(slices_.front());
  slices_.pop_front();
  changed_.notify_all();
  return slice;
}

}  // namespace slamd::sim
