#include "tests/endurance/day.hpp"

#include "daemon/threads/map_correction.hpp"
#include "daemon/threads/streams.hpp"

namespace slamd::endurance {

Day::Day(const Config& config)
    : odometry_{config.vehicle, config.odometry},
      predictor_{config.vehicle, config.odometry.dead_reckoning, config.odometry.imu},
      ring_{2, [](Keyframe& slot) { slot.points.reserve(Streams::kMaxKeyframePoints); }},
      feed_{ring_},
      back_end_{make_relocaliser(config.back_end, config.vehicle)},
      map_{config.map, config.vehicle.T_base_lidar} {}

bool Day::take(replay::Drive& drive) {
  const replay::Event event = drive.next();
  if (std::holds_alternative<std::monostate>(event)) return false;
  if (const auto* sample = std::get_if<const ImuSample*>(&event)) {
    now_ = (*sample)->arrival;
    odometry_.add(**sample);
    predictor_.add(**sample);
  } else if (const auto* packet = std::get_if<const LidarPacket*>(&event)) {
    now_ = (*packet)->arrival;
    odometry_.add(**packet);
  } else if (const auto* fix = std::get_if<const GnssFix*>(&event)) {
    now_ = (*fix)->arrival;
    ++counts_.fixes;
    back_end_.add(**fix);
  } else if (const auto* silence = std::get_if<replay::Silence>(&event)) {
    odometry_.advance(silence->until);
  }
  step();
  return true;
}

void Day::step() {
  while (const ScanResult* result = odometry_.step()) {
    keep(*result);
    map_keyframes();
  }
}

void Day::keep(const ScanResult& result) {
  const NavState& state = result.state;
  feed_.see(result);
  if (result.is_keyframe) feed_.offer(result, odometry_.keyframe_points());
  predictor_.correct(result.snapshot, state);
  if (state.status == TrackingStatus::kInitialising) return;
  trajectory_.add(state.time, state.T_odom_base);
  if (!result.has_scan) return;
  ++counts_.scans;
  counts_.tracking += state.status == TrackingStatus::kTracking ? 1 : 0;
  counts_.lost += state.status == TrackingStatus::kLost ? 1 : 0;
  T_odom_base_ = state.T_odom_base;
}

/// As the mapping thread does, at once.
void Day::map_keyframes() {
  Mapper& mapper = back_end_.mapper();
  for (const Keyframe* keyframe = ring_.front(); keyframe != nullptr; ring_.pop(), keyframe = ring_.front()) {
    ++counts_.keyframes;
    const Relocaliser::Entered entered = back_end_.add(*keyframe);
    if (entered.map_began_anew) map_.clear();
    for (const Keyframe& placed : entered.keyframes) map_.add(placed, mapper.solution()->T_map_odom);
  }
  const std::shared_ptr<const GraphSolution> before = mapper.solution();
  if (mapper.solve()) correct_map(*mapper.solution(), *before, map_);
}

}  // namespace slamd::endurance
