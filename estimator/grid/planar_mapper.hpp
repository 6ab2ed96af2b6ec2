#pragma once
// The back end in the plane: keyframes in, corrected keyframes, T_map_odom and the occupancy grid out. It matches no scan of
// the drive as it comes; that is planar_odometry.

#include <deque>
#include <vector>

#include "estimator/grid/occupancy_builder.hpp"
#include "estimator/grid/planar_odometry.hpp"
#include "estimator/types/occupancy_grid.hpp"

namespace slamd {

struct PlanarMapperConfig {
  OccupancyConfig occupancy;
  std::size_t max_keyframes = 20'000;  // beyond it the oldest are forgotten: 24 h in bounded memory
};

class PlanarMapper {
 public:
  explicit PlanarMapper(const PlanarMapperConfig& config) : config_{config} {}

  /// In order of id. Constant time.
  void add(const PlanarKeyframe& keyframe);
  /// One portion of what is left to do (a search for a loop, a solve): some milliseconds to a second, off the scan path.
  /// False: there was nothing. Deterministic: it depends on calls alone.
  bool work();
  /// All that is left to do, and a last solve.
  void finish() {
    while (work()) {
    }
  }

  /// Of the newest keyframe.
  PlanarPose T_map_odom() const;
  /// A pose of odom at this time, in map: corrections of the keyframes around it, evenly in time between them.
  PlanarPose to_map(HostTime time, const PlanarPose& T_odom_base) const;
  std::size_t keyframes() const { return nodes_.size(); }
  /// Made anew from all keyframes that are kept. Takes some milliseconds a hundred keyframes.
  OccupancyGrid grid() const;

 private:
  struct Node {
    std::uint64_t id;
    PlanarPose T_odom_base, T_map_base;
    PlanarScan scan;
  };
  PlanarPose correction(const Node& node) const { return node.T_map_base * node.T_odom_base.inverse(); }

  PlanarMapperConfig config_;
  std::deque<Node> nodes_;
};

}  // namespace slamd
