#include "estimator/grid/planar_mapper.hpp"

#include <algorithm>

namespace slamd {
namespace {

PlanarPose correction(const PlanarNode& node) { return node.T_map_base * node.T_odom_base.inverse(); }

std::size_t bytes_of(const PlanarNode& node) {
  return (node.scan.points.size() + node.scan.normals.size()) * sizeof(Eigen::Vector2f);
}

}  // namespace

PlanarMapper::PlanarMapper(const PlanarMapperConfig& config, const PlanarOdometryConfig& odometry)
    : config_{config}, closer_{config.loops, odometry.local_map.lines, odometry.local_map.likelihood, odometry.matcher} {}

void PlanarMapper::add(const PlanarKeyframe& keyframe) {
  PlanarNode node;
  node.id = keyframe.id;
  node.T_odom_base = keyframe.T_odom_base;
  node.T_map_base = T_map_odom() * keyframe.T_odom_base;
  node.relative_covariance = keyframe.relative_covariance;
  node.match_covariance = keyframe.match_covariance;
  node.inlier_share = keyframe.inlier_share;
  node.scan = keyframe.scan;
  if (!nodes_.empty()) {
    node.way_m = nodes_.back().way_m + (keyframe.T_odom_base.translation - nodes_.back().T_odom_base.translation).norm();
  }
  bytes_ += bytes_of(node);
  nodes_.push_back(std::move(node));
  while (nodes_.size() > config_.max_keyframes || (bytes_ > config_.byte_budget && nodes_.size() > 1)) forget_oldest();
}

/// What is left begins where the last solve put it.
void PlanarMapper::forget_oldest() {
  const std::uint64_t id = nodes_.front().id;
  std::erase_if(closures_, [id](const PlanarClosure& closure) { return closure.from == id || closure.to == id; });
  bytes_ -= bytes_of(nodes_.front());
  nodes_.pop_front();
}

bool PlanarMapper::work() {
  if (!config_.use_loops || nodes_.empty()) return false;
  const std::uint64_t newest = nodes_.back().id;
  const bool has_grown = static_cast<double>(newest - solved_) >= config_.solve_growth * static_cast<double>(newest);
  if (has_new_closure_ && has_grown) {
    solve();
    return true;
  }
  next_look_ = std::max(next_look_, nodes_.front().id);
  while (next_look_ <= newest) {
    const double way_m = nodes_[next_look_ - nodes_.front().id].way_m;
    if (way_m - looked_m_ < config_.look_m) {
      ++next_look_;
      continue;
    }
    looked_m_ = way_m;
    look();
    return true;
  }
  return false;
}

void PlanarMapper::look() {
  ++stats_.looks;
  const std::optional<PlanarClosure> closure = closer_.look(nodes_, next_look_ - nodes_.front().id);
  ++next_look_;
  if (!closure) return;
  ++stats_.closures;
  closures_.push_back(*closure);
  has_new_closure_ = true;
}

void PlanarMapper::solve() {
  ++stats_.solves;
  SolveLimits limits;
  limits.max_iterations = config_.max_iterations;
  solve_planar_graph(nodes_, closures_, config_.graph, limits);
  solved_ = nodes_.back().id;
  has_new_closure_ = false;
}

void PlanarMapper::finish() {
  while (work()) {
  }
  if (has_new_closure_) solve();
}

PlanarPose PlanarMapper::T_map_odom() const { return nodes_.empty() ? PlanarPose{} : correction(nodes_.back()); }

PlanarPose PlanarMapper::to_map(HostTime time, const PlanarPose& T_odom_base) const {
  if (nodes_.empty()) return T_odom_base;
  const auto after = std::ranges::lower_bound(nodes_, time, {}, [](const PlanarNode& node) { return node.scan.time; });
  if (after == nodes_.begin()) return correction(nodes_.front()) * T_odom_base;
  if (after == nodes_.end()) return T_map_odom() * T_odom_base;
  // Both ends say where the pose is; between them the word of the one goes over into that of the other.
  const PlanarNode& a = *std::prev(after);
  const PlanarPose by_a = correction(a) * T_odom_base;
  const PlanarPose by_b = correction(*after) * T_odom_base;
  const double share = to_seconds(time - a.scan.time) / to_seconds(after->scan.time - a.scan.time);
  return GroupSe2::plus(by_a, share * GroupSe2::minus(by_b, by_a));
}

OccupancyGrid PlanarMapper::grid() const {
  OccupancyBuilder builder{config_.occupancy};
  for (const PlanarNode& node : nodes_) builder.add(node.scan, node.T_map_base);
  return builder.snapshot();
}

}  // namespace slamd
