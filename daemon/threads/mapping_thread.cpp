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
    back_end_.add(*fix);
  }
}

void MappingThread::take(const Keyframe& keyframe) {
  const Relocaliser::Entered entered = back_end_.add(keyframe);
  if (entered.map_began_anew) map_.clear();
  for (const Keyframe& placed : entered.keyframes) map_.add(placed, back_end_.mapper().solution()->T_map_odom);
  tell_link();
}

/// Only when it is another one: the real-time reader compares nothing.
void MappingThread::tell_link() {
  const MapLink link = back_end_.link();
  if (link == told_link_) return;
  told_link_ = link;
  streams_.map_link.store(link);
}

void MappingThread::solve(const std::stop_token& stop) {
  const HostTime deadline = host_now() + kSolveBudget;
  const std::size_t patience = streams_.keyframes.capacity() / 2;
  Mapper& mapper = back_end_.mapper();
  const std::shared_ptr<const GraphSolution> before = mapper.solution();
  const bool solved = mapper.solve([&] {
    return stop.stop_requested() || host_now() > deadline || streams_.keyframes.counts().size > patience;
  });
  if (!solved) return;
  correct_map(*mapper.solution(), *before, map_);
  tell_link();
}

void MappingThread::tell_state() {
  BackEndState state = state_of(back_end_, host_now());
  const std::lock_guard lock{state_mutex_};
  state_ = std::move(state);
}

}  // namespace slamd
