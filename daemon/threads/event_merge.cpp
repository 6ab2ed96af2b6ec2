#include "daemon/threads/event_merge.hpp"

#include <tuple>

namespace slamd {
namespace {

constexpr Duration kLongestSilence = std::chrono::hours{1};

NextEvent oldest(const EventHeads& heads) {
  NextEvent event;
  const auto offer = [&event](NextEvent::Kind kind, const std::optional<HostTime>& arrival) {
    if (arrival && (event.kind == NextEvent::Kind::kNone || *arrival < event.time)) event = {kind, *arrival};
  };
  offer(NextEvent::Kind::kImu, heads.imu);
  offer(NextEvent::Kind::kLidar, heads.lidar);
  offer(NextEvent::Kind::kGnss, heads.gnss);
  offer(NextEvent::Kind::kWheel, heads.wheel);
  offer(NextEvent::Kind::kLaser, heads.laser);
  return event;
}

}  // namespace

NextEvent EventMerge::next(const EventHeads& heads, HostTime now) {
  const HostTime settled = now - config_.hold_back;  // whatever arrived before is in its ring
  const bool all_wait = heads.lidar && heads.imu && heads.gnss;
  NextEvent event = oldest(heads);
  if (event.kind != NextEvent::Kind::kNone && !all_wait && event.time > settled) event = {};

  const HostTime known_until = event.kind == NextEvent::Kind::kNone ? settled : event.time;
  if (last_ && *last_ + config_.silence < known_until && *last_ + config_.silence <= heard_ + kLongestSilence) {
    event = {NextEvent::Kind::kSilence, *last_ + config_.silence};
  }
  if (event.kind == NextEvent::Kind::kNone) return event;
  if (last_ && std::tie(event.time, event.kind) < std::tie(*last_, last_kind_)) {
    ++late_;
  } else {
    last_ = event.time;
    last_kind_ = event.kind;
    if (event.kind != NextEvent::Kind::kSilence) heard_ = event.time;
  }
  return event;
}

}  // namespace slamd
