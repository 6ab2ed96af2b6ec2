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
    make_checkpoint();
    pause_for(kPollPeriod);
  }
  drain();
  if (checkpoints_ != nullptr && checkpoints_->is_on() && back_end_.link().known) {
    checkpoints_->offer(back_end_.mapper().stored(checkpoints_->byte_budget()), host_now());
  }
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
  if (entered.map_began_anew) {
    map_.clear();
    kept_keyframes_ = 0;
  }
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

void MappingThread::restore(StoredMap map, const CloudGrid& grid) {
  for (std::size_t i = 0; i < map.keyframes.size(); ++i) {
    const StoredKeyframe& keyframe = map.keyframes[i];
    if (!is_packed_cloud(keyframe.cloud)) continue;
    PackedPoints points;
    unpack_cloud(keyframe.cloud, grid, [&points](const Eigen::Vector3f& p) {
      if (const auto packed = PackedPoint::of({p.x(), p.y(), p.z(), 0.0F})) points.push_back(*packed);
    });
    map_.restore(i, keyframe.T_map_base, std::move(points));
  }
  back_end_.restore(std::move(map), host_now());
  kept_keyframes_ = back_end_.mapper().keyframes().size();
  tell_link();
}

/// Of a map that has grown, and whose place is known: one that is being looked for must not be written over.
void MappingThread::make_checkpoint() {
  const HostTime now = host_now();
  const Mapper& mapper = back_end_.mapper();
  const std::size_t keyframes = mapper.keyframes().size();
  if (checkpoints_ == nullptr || !checkpoints_->is_on() || keyframes == kept_keyframes_ || !back_end_.link().known) return;
  if (kept_keyframes_ == 0 || checkpoints_->is_due(now)) {
    checkpoints_->offer(mapper.stored(checkpoints_->byte_budget()), now);
  } else {
    for (std::size_t i = kept_keyframes_; i < keyframes; ++i) checkpoints_->offer(mapper.stored_step(i));
  }
  kept_keyframes_ = keyframes;
}

void MappingThread::tell_state() {
  BackEndState state = state_of(back_end_, host_now());
  const std::lock_guard lock{state_mutex_};
  state_ = std::move(state);
}

}  // namespace slamd
