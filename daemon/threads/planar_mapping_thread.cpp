#include "daemon/threads/planar_mapping_thread.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/server/host_clock.hpp"
#include "daemon/threads/pause.hpp"
#include "estimator/grid/scan_normals.hpp"

namespace slamd {
namespace {

constexpr Duration kPollPeriod = std::chrono::milliseconds{20};
constexpr Duration kWorkBudget = std::chrono::seconds{1};  // then keyframes and poses are looked after
constexpr Duration kGridPeriod = std::chrono::seconds{1};  // at least between two grids,
constexpr int kGridRest = 9;                               // and so many times as long as one takes
constexpr std::size_t kMostLooks = 30;                     // keyframes that are looked for before a new map begins
constexpr double kStoredSigma_m = 0.01;                    // of a keyframe relative to the one before, of a map of before
constexpr double kStoredSigma_rad = 0.002;
constexpr double kFoundSigma_m = 0.03;                     // of the place where the vehicle was found again
constexpr double kFoundSigma_rad = 0.01;
constexpr double kLongestBelieved_s = 10.0;                // that a motion is believed to have gone on

Pose in_space(const PlanarPose& T) {
  return {Eigen::Quaterniond{Eigen::AngleAxisd{T.yaw_rad, Eigen::Vector3d::UnitZ()}}, {T.translation.x(), T.translation.y(), 0.0}};
}

PlanarPose pose_of(const StoredPlanarKeyframe& keyframe) { return {keyframe.pose.head<2>(), keyframe.pose[2]}; }

Eigen::Matrix3d covariance(double sigma_m, double sigma_rad) {
  return Eigen::Vector3d{sigma_m, sigma_m, sigma_rad}.cwiseAbs2().asDiagonal();
}

}  // namespace

nlohmann::json to_json(const PlanarState& state) {
  const Pose T = in_space(state.T_map_odom);
  const auto& q = T.rotation;
  return {{"keyframes", state.keyframes},
          {"closures", state.closures},
          {"T_map_odom", {{"translation_m", {T.translation.x(), T.translation.y(), 0.0}}, {"rotation_quat_xyzw", {q.x(), q.y(), q.z(), q.w()}}}},
          {"relocalising", state.relocalising},
          {"relocalised", state.relocalisation.relocalised},
          {"maps_begun_anew", state.relocalisation.begun_anew},
          {"grid_keyframes", state.grid_keyframes},
          {"grid_s", state.grid_s}};
}

PlanarMappingThread::PlanarMappingThread(const Slam2dConfig& config, PlanarKeeper keeper, Streams& streams, GridStore& grid,
                                         TrajectoryStore& trajectory)
    : config_{config},
      mapper_{config.mapper, config.odometry},
      maker_{config.mapper.occupancy},
      keeper_{std::move(keeper)},
      streams_{streams},
      grid_{grid},
      trajectory_{trajectory} {
  tell_state();
}

void PlanarMappingThread::restore(const StoredPlanarMap& map) {
  if (map.empty()) return;
  search_.emplace(PlanarRelocaliserConfig{});
  const PlanarPose last = pose_of(map.back());
  for (std::size_t i = 0; i < map.size(); ++i) {
    PlanarKeyframe keyframe;
    keyframe.T_odom_base = pose_of(map[i]);
    keyframe.relative_covariance = keyframe.match_covariance = covariance(kStoredSigma_m, kStoredSigma_rad);
    // Before all that is to come, whatever clock it was of.
    keyframe.scan.time = HostTime{} + Duration{static_cast<std::int64_t>(i) + 1};
    keyframe.scan.points = map[i].points;
    keyframe.scan.origin = map[i].origin;
    for (const Eigen::Vector2f& p : map[i].points) keyframe.scan.mean_range_m += (p - map[i].origin).norm() / static_cast<float>(map[i].points.size());
    find_normals(keyframe.scan, config_.odometry.scan.spacing_m);
    if ((keyframe.T_odom_base.translation - last.translation).norm() < search_->reach_m()) search_->add(keyframe.scan, keyframe.T_odom_base);
    enter(std::move(keyframe));
  }
  left_.assign(map.end() - static_cast<std::ptrdiff_t>(std::min<std::size_t>(2, map.size())), map.end());
  tell_link();
}

void PlanarMappingThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    drain();
    work(stop);
    if (maker_.has_changed() && host_now() >= next_grid_) make_grid();
    if (!search_) keeper_.keep(mapper_, host_now());
    tell_state();
    pause_for(kPollPeriod);
  }
  drain();
  if (!search_) keeper_.keep(mapper_, host_now());
}

void PlanarMappingThread::drain() {
  for (; const StampedPose* pose = streams_.path.front(); streams_.path.pop()) trajectory_.add(pose->time, pose->T_odom_base);
  for (; const PlanarKeyframe* keyframe = streams_.planar_keyframes.front(); streams_.planar_keyframes.pop()) take(*keyframe);
  while (streams_.fixes.front() != nullptr) streams_.fixes.pop();  // the plane has no use for them
  tell_link();
}

void PlanarMappingThread::take(const PlanarKeyframe& keyframe) {
  if (!search_) return enter(keyframe);
  waiting_.push_back(keyframe);
  const PlanarPose T_map_believed = believed(keyframe);
  const double unseen_m = (T_map_believed.translation - pose_of(left_.back()).translation).norm();
  if (const auto found = search_->look(keyframe.scan, T_map_believed, unseen_m)) {
    ++relocalisation_.relocalised;
    return link(found->T_map_base * keyframe.T_odom_base.inverse());
  }
  if (waiting_.size() < kMostLooks) return;
  ++relocalisation_.begun_anew;
  mapper_ = PlanarMapper{config_.mapper, config_.odometry};
  maker_.clear();
  keeper_.forget();
  entered_ = 0;
  link({});
}

/// Where the map of before ended, gone on as it went then.
PlanarPose PlanarMappingThread::believed(const PlanarKeyframe& keyframe) const {
  const PlanarPose last = pose_of(left_.back());
  const PlanarPose here = last * (waiting_.front().T_odom_base.inverse() * keyframe.T_odom_base);
  const double since_s = to_seconds(waiting_.front().scan.time - left_.back().time);
  const double step_s = to_seconds(left_.back().time - left_.front().time);
  if (step_s <= 0.0 || step_s > 1.0 || since_s <= 0.0 || since_s > kLongestBelieved_s) return here;
  const GroupSe2::Tangent step = GroupSe2::minus(last, pose_of(left_.front()));
  const PlanarPose gone = GroupSe2::plus(last, step * (since_s / step_s));
  return gone * (waiting_.front().T_odom_base.inverse() * keyframe.T_odom_base);
}

/// The odometry's place in the chain is known: what has waited goes in.
void PlanarMappingThread::link(const PlanarPose& T_chain_odom) {
  T_chain_odom_ = T_chain_odom;
  search_.reset();
  std::vector<PlanarKeyframe> waiting = std::exchange(waiting_, {});
  if (entered_ > 0) waiting.front().relative_covariance = covariance(kFoundSigma_m, kFoundSigma_rad);
  for (PlanarKeyframe& keyframe : waiting) enter(std::move(keyframe));
}

void PlanarMappingThread::enter(PlanarKeyframe keyframe) {
  keyframe.id = entered_++;
  keyframe.T_odom_base = T_chain_odom_ * keyframe.T_odom_base;
  mapper_.add(keyframe);
}

void PlanarMappingThread::work(const std::stop_token& stop) {
  const HostTime deadline = host_now() + kWorkBudget;
  const auto may_go_on = [&] { return !stop.stop_requested() && host_now() < deadline; };
  const std::uint64_t solves = mapper_.stats().solves;
  while (may_go_on() && mapper_.work()) {
  }
  if (mapper_.stats().solves != solves) maker_.corrected();
  tell_link();
  while (may_go_on() && maker_.work(mapper_, entered_)) {
  }
}

/// Only when it is another one: the real-time reader compares nothing.
void PlanarMappingThread::tell_link() {
  const MapLink link{.T_map_odom = in_space(mapper_.T_map_odom() * T_chain_odom_), .odom_piece = 0, .known = !search_};
  if (link == told_link_) return;
  told_link_ = link;
  streams_.map_link.store(link);
}

/// The larger the map, the rarer: one in ten seconds of this thread at most goes into snapshots.
void PlanarMappingThread::make_grid() {
  const HostTime begin = host_now();
  grid_keyframes_ = maker_.shown_keyframes();
  grid_.put(maker_.snapshot(), begin);
  const Duration took = host_now() - begin;
  next_grid_ = begin + std::max(kGridPeriod, kGridRest * took);
  grid_s_ = to_seconds(took);
}

void PlanarMappingThread::tell_state() {
  PlanarState state{mapper_.keyframes().size(), mapper_.closures().size(), mapper_.T_map_odom() * T_chain_odom_, search_.has_value(), relocalisation_, grid_keyframes_, grid_s_, keeper_.report()};
  const std::lock_guard lock{state_mutex_};
  state_ = std::move(state);
}

}  // namespace slamd
