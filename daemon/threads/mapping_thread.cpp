#include "daemon/threads/mapping_thread.hpp"

#include "daemon/server/host_clock.hpp"
#include "daemon/threads/map_correction.hpp"
#include "daemon/threads/pause.hpp"

namespace slamd {
namespace {

constexpr Duration kPollPeriod = std::chrono::milliseconds{20};
constexpr Duration kSolveBudget = std::chrono::seconds{1};  // then keyframes and poses are looked after; the next goes on

}  // namespace

void MappingThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    drain();
    solve(stop);
    tell_state();
    pause_for(kPollPeriod);
  }
  drain();
}

void MappingThread::drain() {
  for (; const StampedPose* pose = streams_.path.front(); streams_.path.pop())
    trajectory_.add(pose->time, pose->T_odom_base);
  for (; const Keyframe* keyframe = streams_.keyframes.front(); streams_.keyframes.pop()) take(*keyframe);
  for (; const GnssFix* fix = streams_.fixes.front(); streams_.fixes.pop()) {
    if (fix->quality != GnssQuality::kNone) fixes_.fetch_add(1, std::memory_order_relaxed);
    mapper_.add(*fix);
  }
}

void MappingThread::take(const Keyframe& keyframe) {
  mapper_.add(keyframe);
  map_.add(keyframe, mapper_.solution()->T_map_odom);
}

void MappingThread::solve(const std::stop_token& stop) {
  const HostTime deadline = host_now() + kSolveBudget;
  const std::size_t patience = streams_.keyframes.capacity() / 2;
  const std::shared_ptr<const GraphSolution> before = mapper_.solution();
  const bool solved = mapper_.solve([&] {
    return stop.stop_requested() || host_now() > deadline || streams_.keyframes.counts().size > patience;
  });
  if (!solved) return;
  const std::shared_ptr<const GraphSolution> solution = mapper_.solution();
  correct_map(*solution, *before, map_);
  streams_.T_map_odom.store(solution->T_map_odom);
}

void MappingThread::tell_state() {
  BackEndState state = state_of(mapper_, host_now());
  const std::lock_guard lock{state_mutex_};
  state_ = std::move(state);
}

}  // namespace slamd
