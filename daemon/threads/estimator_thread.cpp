#include "daemon/threads/estimator_thread.hpp"

#include <optional>
#include <utility>

#include "daemon/server/host_clock.hpp"
#include "daemon/threads/pause.hpp"

namespace slamd {
namespace {

template <class T>
std::optional<HostTime> oldest_arrival(SpscRing<T>& ring) {
  const T* item = ring.front();
  return item != nullptr ? std::optional{item->arrival} : std::nullopt;
}

template <class T>
void pass_on(SpscRing<T>& ring, FrontEnd& front_end) {
  front_end.add(*ring.front());
  ring.pop();
}

}  // namespace

EstimatorThread::EstimatorThread(const EstimatorThreadConfig& config, std::unique_ptr<FrontEnd> front_end, Streams& streams)
    : config_{config}, merge_{config.merge}, front_end_{std::move(front_end)}, streams_{streams} {}

void EstimatorThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    passes_.fetch_add(1, std::memory_order_relaxed);
    if (!take_event(host_now())) pause_for(config_.poll_period);
  }
}

bool EstimatorThread::take_event(HostTime now) SLAMD_NONBLOCKING {
  const NextEvent event = merge_.next({oldest_arrival(streams_.imu), oldest_arrival(streams_.lidar), oldest_arrival(streams_.gnss),
                                       oldest_arrival(streams_.wheel), oldest_arrival(streams_.laser)},
                                      now);
  late_events_.store(merge_.late(), std::memory_order_relaxed);
  if (event.kind != NextEvent::Kind::kNone) newest_event_ = event.time;
  switch (event.kind) {
    case NextEvent::Kind::kNone: return false;
    case NextEvent::Kind::kLidar: pass_on(streams_.lidar, *front_end_); break;
    case NextEvent::Kind::kImu: pass_on(streams_.imu, *front_end_); break;
    case NextEvent::Kind::kWheel: pass_on(streams_.wheel, *front_end_); break;
    case NextEvent::Kind::kLaser: pass_on(streams_.laser, *front_end_); break;
    case NextEvent::Kind::kGnss:
      streams_.fixes.try_push(*streams_.gnss.front());
      streams_.gnss.pop();
      break;
    case NextEvent::Kind::kSilence: front_end_->advance(event.time); break;
  }
  front_end_->take_scans(newest_event_);
  return true;
}

}  // namespace slamd
