#include "estimator/graph/mapper.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace slamd {
namespace {

constexpr double kLeastGrowth = 50.0;  // keyframes
// Three copies of the estimates (here, published, the one before), the chain, the graph, and Ceres' problem while it solves.
constexpr std::size_t kBytesAKeyframe = 3 * sizeof(KeyframeEstimate) + 1024 + 4096;
constexpr Duration kBeforeThisRun = std::chrono::seconds{2};  // GPS ties no fix across such a gap
constexpr std::uint32_t kPieceOfEarlierRun = std::numeric_limits<std::uint32_t>::max();

bool is_usable(const Keyframe& keyframe) {
  const Pose& T = keyframe.state.T_odom_base;
  return T.translation.allFinite() && T.rotation.coeffs().allFinite() && keyframe.relative_covariance.allFinite() &&
         keyframe.up_base.allFinite() && keyframe.up_sigma_rad >= 0.0;
}

}  // namespace

Mapper::Mapper(const MapperConfig& config, std::unique_ptr<LoopSource> loops, std::unique_ptr<PositionSource> positions)
    : config_{config}, loops_{std::move(loops)}, positions_{std::move(positions)}, graph_{config.graph} {}

void Mapper::add(const Keyframe& keyframe) {
  if (bytes() >= config_.byte_budget) {
    ++left_out_;
    return;
  }
  if (keyframe.id != keyframes_.size() || !is_usable(keyframe)) {
    ++rejected_;
    return;
  }
  keep(keyframe);
  if (loops_) loops_->add(keyframe);
}

void Mapper::keep(const Keyframe& keyframe) {
  graph_.add(keyframe);
  odometry_.add(keyframe.state.T_odom_base, keyframe.relative_covariance);
  keyframes_.push_back({keyframe.state.time, keyframe.state.T_odom_base, graph_.poses().back()});
  if (positions_) positions_->add(keyframe);
  const NavState& state = keyframe.state;
  sensors_ = {state.gyro_bias_rads, state.accel_bias_mps2, state.T_imu_lidar};
  motion_.time = state.time;
  motion_.velocity_mps = state.T_odom_base.rotation.conjugate() * state.velocity_mps;
  motion_.angular_velocity_rads = state.angular_velocity_rads;
}

StoredMap Mapper::stored(std::size_t byte_budget) const {
  StoredMap map;
  if (keyframes_.empty() || !loops_) return map;
  std::size_t first = keyframes_.size();
  for (std::size_t bytes = 0; first > loops_->forgotten(); --first) {
    bytes += loops_->packed(first - 1).size() + sizeof(StoredKeyframe);
    if (bytes > byte_budget) break;
  }
  for (std::size_t i = first; i < keyframes_.size(); ++i) {
    const std::span<const std::uint8_t> cloud = loops_->packed(i);
    const Matrix6d covariance = i > first ? odometry_.relative_covariance(i - 1, i) : Matrix6d{Matrix6d::Zero()};
    map.keyframes.push_back({keyframes_[i].time, keyframes_[i].T_map_base, covariance, {cloud.begin(), cloud.end()}});
  }
  map.closures = stored_closures(first);
  map.T_map_base = keyframes_.back().T_map_base;
  map.motion = motion_;
  map.sensors = sensors_;
  if (const std::optional<StoredEnu> enu = stored_enu()) {
    map.enu_valid = true;
    map.enu = *enu;
  }
  return map;
}

StoredStep Mapper::stored_step(std::size_t keyframe) const {
  StoredStep step;
  step.time = keyframes_[keyframe].time;
  step.T_before_this = odometry_.relative(keyframe - 1, keyframe);
  step.relative_covariance = odometry_.relative_covariance(keyframe - 1, keyframe);
  if (loops_) {
    const std::span<const std::uint8_t> cloud = loops_->packed(keyframe);
    step.cloud.assign(cloud.begin(), cloud.end());
  }
  step.motion = motion_;
  step.sensors = sensors_;
  return step;
}

/// Those between keyframes from `first` on.
std::vector<StoredClosure> Mapper::stored_closures(std::size_t first) const {
  std::vector<StoredClosure> stored;
  for (const LoopClosure& closure : loops_->closures()) {
    if (closure.from < first || closure.to < first) continue;
    stored.push_back({static_cast<std::uint32_t>(closure.from - first), static_cast<std::uint32_t>(closure.to - first),
                      closure.T_from_to, closure.covariance});
  }
  return stored;
}

std::optional<StoredEnu> Mapper::stored_enu() const {
  if (!enu_) return restored_enu_;
  const EnuOrigin origin = positions_->origin();
  StoredEnu enu{enu_->yaw_rad, enu_->translation, {}, origin.latitude_deg, origin.longitude_deg, origin.ellipsoid_height_m};
  std::copy_n(enu_->covariance.data(), enu.covariance.size(), enu.covariance.begin());
  return enu;
}

void Mapper::restore(StoredMap map, HostTime now) {
  const Duration shift = map.keyframes.empty() ? Duration{} : now - map.keyframes.back().time - kBeforeThisRun;
  for (StoredKeyframe& stored : map.keyframes) {
    Keyframe keyframe;
    keyframe.id = keyframes_.size();
    keyframe.state.time = stored.time + shift;
    keyframe.state.odom_piece = kPieceOfEarlierRun;
    keyframe.state.T_odom_base = stored.T_map_base;
    keyframe.relative_covariance = stored.relative_covariance;
    keyframe.up_base = stored.T_map_base.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    keyframe.up_sigma_rad = 0.0;  // the graph's own floor
    keep(keyframe);
    if (loops_) loops_->restore(keyframe, std::move(stored.cloud));
  }
  sensors_ = map.sensors;
  if (map.enu_valid) restored_enu_ = map.enu;
  restore_closures(map.closures);
}

void Mapper::restore_closures(std::span<const StoredClosure> closures) {
  MapGraphSolve as_left;
  if (loops_) {
    std::vector<LoopClosure> restored;
    for (const StoredClosure& c : closures) restored.push_back({c.from, c.to, c.T_from_to, c.covariance});
    loops_->restore(view(), restored);
    as_left.closure_weights.assign(loops_->closures().size(), 1.0);
  }
  publish(as_left);
}

void Mapper::add(const GnssFix& fix) {
  if (positions_ && bytes() < config_.byte_budget) positions_->add(fix);
}

std::size_t Mapper::bytes() const {
  return keyframes_.size() * kBytesAKeyframe + (loops_ ? loops_->bytes() : 0) + (positions_ ? positions_->bytes() : 0);
}

bool Mapper::solve(const Cancelled& cancelled) {
  if (keyframes_.empty()) return false;
  const bool asked = ask_sources(cancelled);
  pending_ = pending_ || asked || grown(config_.resolve_growth, kLeastGrowth);
  return pending_ && grown(config_.closure_growth, 1.0) && solve_whole(cancelled);
}

bool Mapper::finish() {
  if (keyframes_.empty()) return false;
  ask_sources({});
  return solve_whole({});
}

bool Mapper::ask_sources(const Cancelled& cancelled) {
  const bool closed = loops_ && loops_->update(view(), cancelled);
  const bool positioned = positions_ && positions_->update(view(), enu_);
  return closed || positioned;
}

bool Mapper::grown(double share, double at_least) const {
  const double solved = static_cast<double>(solution_->keyframes.size());
  return static_cast<double>(keyframes_.size()) >= solved + std::max(at_least, share * solved);
}

bool Mapper::solve_whole(const Cancelled& cancelled) {
  GraphConstraints constraints;
  if (loops_) constraints.closures = loops_->closures();
  if (positions_ && positions_->initial_alignment()) {
    constraints.positions = positions_->positions();
    const bool rigid = constraints.positions.empty();
    constraints.enu = enu_ && !rigid ? enu_ : positions_->initial_alignment();
  }
  SolveLimits limits;
  limits.max_iterations = config_.max_iterations;
  limits.cancelled = cancelled;
  const MapGraphSolve solve = graph_.solve(constraints, limits);
  pending_ = solve.outcome.cancelled;
  if (!solve.outcome.usable) return false;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) keyframes_[i].T_map_base = graph_.poses()[i];
  if (solve.outcome.cancelled) return false;
  if (loops_) loops_->weigh(solve.closure_weights);
  if (positions_) positions_->weigh(solve.position_weights);
  enu_ = solve.enu || !positions_ ? solve.enu : positions_->initial_alignment();
  publish(solve);
  return true;
}

void Mapper::publish(const MapGraphSolve& solve) {
  auto next = std::make_shared<GraphSolution>();
  next->T_map_odom = keyframes_.back().T_map_base * keyframes_.back().T_odom_base.inverse();
  next->enu_valid = enu_.has_value();
  if (enu_) {
    next->enu = *enu_;
    next->enu_origin = positions_->origin();
  } else if (restored_enu_) {
    const StoredEnu& enu = *restored_enu_;
    next->enu_valid = true;
    next->enu = {enu.yaw_rad, enu.translation, Eigen::Map<const Matrix4d>{enu.covariance.data()}};
    next->enu_origin = {enu.latitude_deg, enu.longitude_deg, enu.ellipsoid_height_m};
  }
  next->keyframes = keyframes_;
  next->changes = solution_->changes + 1;
  next->closures = solve.closure_weights.size();
  next->positions = solve.position_weights.size();
  next->objective = solve.outcome.objective;
  next->iterations = solve.outcome.iterations;
  next->converged = solve.outcome.converged;
  solution_ = std::move(next);
}

std::vector<FixReport> Mapper::fix_reports() const {
  return positions_ ? positions_->reports() : std::vector<FixReport>{};
}

std::span<const LoopCandidateReport> Mapper::loop_reports() const {
  return loops_ ? loops_->reports() : std::span<const LoopCandidateReport>{};
}

}  // namespace slamd
