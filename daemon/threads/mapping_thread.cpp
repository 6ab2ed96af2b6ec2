#include "daemon/threads/mapping_thread.hpp"

#include "daemon/server/host_clock.hpp"
#include "daemon/threads/pause.hpp"

namespace slamd {
namespace {

constexpr Duration kPollPeriod = std::chrono::milliseconds{20};

}  // namespace

void MappingThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    drain();
    pause_for(kPollPeriod);
  }
  drain();
}

void MappingThread::drain() {
  for (; const StampedPose* pose = streams_.path.front(); streams_.path.pop())
    trajectory_.add(pose->time, pose->T_odom_base);
  for (; const Keyframe* keyframe = streams_.keyframes.front(); streams_.keyframes.pop()) map_.add(*keyframe);
  for (; const GnssFix* fix = streams_.fixes.front(); streams_.fixes.pop()) {
    if (fix->quality != GnssQuality::kNone) fixes_.fetch_add(1, std::memory_order_relaxed);
  }
}

}  // namespace slamd
