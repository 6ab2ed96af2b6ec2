#pragma once
// The back end in the plane: keyframes in, corrected keyframes, T_map_odom and the occupancy grid out. It matches no scan of
// the drive as it comes; that is planar_odometry.

#include <vector>

#include "estimator/grid/occupancy_builder.hpp"
#include "estimator/grid/planar_graph.hpp"
#include "estimator/grid/planar_loop_closer.hpp"
#include "estimator/grid/planar_odometry.hpp"
#include "estimator/types/occupancy_grid.hpp"

namespace slamd {

struct PlanarMapperConfig {
  OccupancyConfig occupancy;
  PlanarLoopConfig loops;
  PlanarGraphConfig graph;
  bool use_loops = true;
  double look_m = 1.0;                   // driven between two looks for a loop
  double solve_growth = 0.01;            // share by which the drive grows between two solves
  int max_iterations = 30;               // of a solve
  std::size_t max_keyframes = 20'000;    // beyond it, and beyond the bytes of their points, the oldest are forgotten:
  std::size_t byte_budget = 256U << 20U;  // 24 h in bounded memory
};

struct PlanarMapperStats {
  std::uint64_t looks = 0, closures = 0, solves = 0;
};

class PlanarMapper {
 public:
  /// The loop closer matches as the front end does.
  PlanarMapper(const PlanarMapperConfig& config, const PlanarOdometryConfig& odometry);

  /// In order of id. Constant time.
  void add(const PlanarKeyframe& keyframe);
  /// One portion of what is left to do, a look for a loop or a solve: some milliseconds to a second, off the scan path.
  /// False: there was nothing. Deterministic: it depends on calls alone.
  bool work();
  /// All that is left to do, and a last solve.
  void finish();

  /// Of the newest keyframe.
  PlanarPose T_map_odom() const;
  /// A pose of odom at this time, in map: corrections of the keyframes around it, evenly in time between them.
  PlanarPose to_map(HostTime time, const PlanarPose& T_odom_base) const;
  const PlanarNodes& keyframes() const { return nodes_; }
  const std::vector<PlanarClosure>& closures() const { return closures_; }
  const PlanarMapperStats& stats() const { return stats_; }
  /// Made anew from all keyframes that are kept. Takes some milliseconds a hundred keyframes.
  OccupancyGrid grid() const;

 private:
  void forget_oldest();
  void look();
  void solve();

  PlanarMapperConfig config_;
  PlanarLoopCloser closer_;
  PlanarNodes nodes_;
  std::vector<PlanarClosure> closures_;
  PlanarMapperStats stats_;
  std::size_t bytes_ = 0;           // of the nodes' points
  std::uint64_t next_look_ = 0;     // id
  double looked_m_ = 0.0;           // way at the last look
  std::uint64_t solved_ = 0;        // newest id at the last solve
  bool has_new_closure_ = false;
};

}  // namespace slamd
