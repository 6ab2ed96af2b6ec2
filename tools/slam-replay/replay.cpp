#include "tools/slam-replay/replay.hpp"

#include "daemon/threads/map_correction.hpp"

namespace slamd::replay {

Replay::Replay(const VehicleGeometry& vehicle, const OdometryConfig& odometry, const MapStoreConfig& map,
               Relocaliser relocaliser)
    : odometry_{vehicle, odometry},
      predictor_{vehicle, odometry.dead_reckoning, odometry.imu},
      relocaliser_{std::move(relocaliser)},
      map_{map, vehicle.T_base_lidar} {
  odometry_.set_stage_listener(&times_);
}

void Replay::run(Drive& drive, Output& output, Progress& progress, bool with_map) {
  const auto begin = std::chrono::steady_clock::now();
  with_map_ = with_map;
  while (take(drive.next(), output)) {
    step(drive, output);
    progress.show(drive.progress());
  }
  // Nothing more will come: the last scan's deadline passes.
  odometry_.advance(last_ + std::chrono::milliseconds{200});
  step(drive, output);
  if (with_map_) finish_map();
  report_.drive = last_ - first_;
  report_.wall = std::chrono::steady_clock::now() - begin;
}

bool Replay::take(const Event& event, Output& output) {
  const auto note = [this](HostTime arrival) {
    if (first_ == HostTime{}) first_ = arrival;
    last_ = std::max(last_, arrival);
  };
  if (const auto* const* sample = std::get_if<const ImuSample*>(&event)) {
    note((*sample)->arrival);
    odometry_.add(**sample);
    const NavState state = predictor_.add(**sample);
    if (state.status != TrackingStatus::kInitialising) output.imu_rate(state);
  } else if (const auto* const* packet = std::get_if<const LidarPacket*>(&event)) {
    note((*packet)->arrival);
    odometry_.add(**packet);
  } else if (const auto* const* fix = std::get_if<const GnssFix*>(&event)) {
    note((*fix)->arrival);
    ++report_.fixes;
    if (with_map_) relocaliser_.add(**fix);
  } else if (const auto* silence = std::get_if<Silence>(&event)) {
    odometry_.advance(silence->until);
  }
  return !std::holds_alternative<std::monostate>(event);
}

void Replay::step(const Drive& drive, Output& output) {
  for (;;) {
    times_.begin_scan();
    const std::optional<HostTime> due = odometry_.due();
    const ScanResult* result = odometry_.step(due ? drive.scan_share(*due) : 1.0);
    if (result == nullptr) return;
    if (result->has_scan) times_.end_scan();
    keep(*result, output);
  }
}

void Replay::keep(const ScanResult& result, Output& output) {
  const bool placed = !with_map_ || relocaliser_.link().places(result.state);
  const NavState state = placed ? result.state : unplaced(result.state);
  const bool changed = report_.status.empty() || report_.status.back().status != state.status ||
                       report_.status.back().reasons != state.reasons;
  if (changed) report_.status.push_back({state.time, state.status, state.reasons});
  if (state.status == TrackingStatus::kInitialising) return;
  predictor_.correct(result.snapshot, result.state);
  report_.last = state;
  if (!result.has_scan) return;
  ++report_.scans;
  output.scan(result.state);
  if (with_map_) path_.push_back(result.state);
  if (result.is_keyframe) keep_keyframe(result, output);
}

void Replay::keep_keyframe(const ScanResult& result, Output& output) {
  keyframe_.id = report_.keyframes++;
  keyframe_.state = result.state;
  keyframe_.relative_covariance = result.relative_covariance;
  keyframe_.up_base = result.up.up_base;
  keyframe_.up_sigma_rad = result.up.sigma_rad;
  keyframe_.scan_span = result.scan_span;
  keyframe_.points = odometry_.keyframe_points();
  output.keyframe(keyframe_);
  if (!with_map_) return;
  const Relocaliser::Entered entered = relocaliser_.add(keyframe_);
  Mapper& mapper = relocaliser_.mapper();
  if (entered.map_began_anew) map_.clear();
  for (const Keyframe& keyframe : entered.keyframes) map_.add(keyframe, mapper.solution()->T_map_odom);
  const std::shared_ptr<const GraphSolution> before = mapper.solution();
  if (mapper.solve()) correct_map(*mapper.solution(), *before, map_);
}

std::vector<StampedPose> Replay::path() const {
  std::vector<StampedPose> path;
  for (const NavState& state : path_) {
    const std::optional<Pose> T_chain_odom = relocaliser_.T_chain_odom(state.odom_piece);
    if (T_chain_odom) path.push_back({state.time, *T_chain_odom * state.T_odom_base});
  }
  return path;
}

void Replay::finish_map() {
  Mapper& mapper = relocaliser_.mapper();
  const std::shared_ptr<const GraphSolution> before = mapper.solution();
  if (mapper.finish()) correct_map(*mapper.solution(), *before, map_);
  report_.solution = mapper.solution();
  report_.relocalisation = relocaliser_.counts();
  if (mapper.positions() != nullptr) report_.latency = mapper.positions()->latency();
}

}  // namespace slamd::replay
