#include "estimator/grid/planar_mapper.hpp"

#include <algorithm>

namespace slamd {

void PlanarMapper::add(const PlanarKeyframe& keyframe) {
  nodes_.push_back({keyframe.id, keyframe.T_odom_base, T_map_odom() * keyframe.T_odom_base, keyframe.scan});
  if (nodes_.size() > config_.max_keyframes) nodes_.pop_front();
}

bool PlanarMapper::work() { return false; }

PlanarPose PlanarMapper::T_map_odom() const { return nodes_.empty() ? PlanarPose{} : correction(nodes_.back()); }

PlanarPose PlanarMapper::to_map(HostTime time, const PlanarPose& T_odom_base) const {
  if (nodes_.empty()) return T_odom_base;
  const auto after = std::ranges::lower_bound(nodes_, time, {}, [](const Node& node) { return node.scan.time; });
  if (after == nodes_.begin()) return correction(nodes_.front()) * T_odom_base;
  if (after == nodes_.end()) return T_map_odom() * T_odom_base;
  // Both ends say where the pose is; between them the word of the one goes over into that of the other.
  const Node& a = *std::prev(after);
  const PlanarPose by_a = correction(a) * T_odom_base;
  const PlanarPose by_b = correction(*after) * T_odom_base;
  const double share = to_seconds(time - a.scan.time) / to_seconds(after->scan.time - a.scan.time);
  return GroupSe2::plus(by_a, share * GroupSe2::minus(by_b, by_a));
}

OccupancyGrid PlanarMapper::grid() const {
  OccupancyBuilder builder{config_.occupancy};
  for (const Node& node : nodes_) builder.add(node.scan, node.T_map_base);
  return builder.snapshot();
}

}  // namespace slamd
