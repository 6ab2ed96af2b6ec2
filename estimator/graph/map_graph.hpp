#pragma once
// The graph of one drive: keyframes chained by odometry and levelled by gravity, closures and GPS positions between them.
// It decides nothing about closures and positions but their robust weight; when to solve is the mapper's.

#include <optional>
#include <span>
#include <vector>

#include "estimator/graph/gnss_position.hpp"
#include "estimator/graph/group_se3.hpp"
#include "estimator/graph/loop_closure.hpp"
#include "estimator/graph/minimise.hpp"
#include "estimator/graph/pose_graph.hpp"
#include "estimator/types/keyframe.hpp"

namespace slamd {

struct MapGraphConfig {
  double gravity_sigma_rad = 0.003;   // at least, of a keyframe's direction of gravity: model error of the filter; known worse
                                      // it counts for little
  double gravity_correlation = 20.0;  // this many keyframes share one error of gravity
  double closure_phi = 12.6;          // chi2 of a closure from which on it counts less (95 % of 6 degrees of freedom)
  double closure_correlation = 4.0;   // neighbouring closures share so much of their sub-maps that so many have one error
  double position_phi = 7.8;          // likewise of a GPS position (95 % of 3)
};

/// What closes and anchors the chain at this solve. All must outlive the call only.
struct GraphConstraints {
  std::span<const LoopClosure> closures;
  std::span<const GnssPosition> positions;
  std::optional<EnuAlignment> enu;  // where the alignment starts; needed when there are positions
};

struct MapGraphSolve {
  SolveOutcome outcome;
  std::vector<double> closure_weights;   // in the order of the constraints, 0..1
  std::vector<double> position_weights;
  std::optional<EnuAlignment> enu;       // with covariance; only with positions
};

class MapGraph {
 public:
  explicit MapGraph(const MapGraphConfig& config = {}) : config_{config} {}

  /// Appends a keyframe where odometry puts it relative to the newest one. Constant time, some microseconds.
  void add(const Keyframe& keyframe);

  /// Least squares over the whole graph from where it is now. Ids beyond the keyframes must not occur.
  MapGraphSolve solve(const GraphConstraints& constraints, const SolveLimits& limits);

  /// T_map_base of each keyframe, by id.
  std::span<const Pose> poses() const { return poses_; }

 private:
  struct Node {
    Eigen::Vector3d up_base;
    double up_sigma_rad;
  };

  class Problem;

  double gravity_sigma(double told_rad) const;

  MapGraphConfig config_;
  std::vector<Pose> poses_;
  std::vector<Node> nodes_;             // one a keyframe
  std::vector<Edge<GroupSe3>> chain_;   // one a keyframe but the first
  Pose anchor_;         // the first keyframe, where odometry began
  Pose T_odom_newest_;
};

}  // namespace slamd
