#pragma once
// The pose of a scan in a window that fits a likelihood best: the exact maximum over all cells and angles of the window, by
// branch and bound. Finer than a cell is line_matcher's.
// Source: Olson, "Real-Time Correlative Scan Matching" (2009); bounds over blocks as Hess et al., "Real-Time Loop Closure in
// 2D LIDAR SLAM" (2016), section V-B.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "estimator/grid/likelihood_pyramid.hpp"

namespace slamd {

struct SearchWindow {
  PlanarPose centre;         // T_map_base
  double half_width_m = 0.3;  // in x and y of the map
  double half_yaw_rad = 0.1;
  double centre_share = 0.0;  // score (0..1) that a pose in a corner or at the end of the angles loses against the centre
  double least_score = 0.0;   // nothing worse is looked for
  int most_looks = 100'000;   // blocks whose bound is computed: the worst case's time
};

struct CorrelativeMatch {
  PlanarPose T_map_base;
  double score = 0.0;   // mean likelihood of the points, 0..1, without what the distance from the centre costs
  double value = 0.0;   // with it: what is maximised
  bool exact = true;    // false: most_looks were not enough, and this is the best so far
};

class CorrelativeMatcher {
 public:
  /// points  base frame, at least one; their number is the cost. Nothing when no pose reaches least_score.
  /// The maximum is exact over the grid of cells (of the likelihood) and angles (of which the farthest point moves by a cell).
  std::optional<CorrelativeMatch> match(const LikelihoodPyramid& likelihood, std::span<const Eigen::Vector2f> points,
                                        const SearchWindow& window);
  /// The angle between two looks.
  static double yaw_step(std::span<const Eigen::Vector2f> points, double cell_m);

 private:
  struct Node {
    int yaw, x, y, level;  // angle, first shift of the block in cells
    double bound;
  };
  double value_bound(const Node& node);
  void descend(std::vector<Node>& nodes);
  void rotate(const LikelihoodPyramid& likelihood, std::span<const Eigen::Vector2f> points, const SearchWindow& window);
  std::span<const Eigen::Vector2i> rotated(int yaw) const {
    return {cells_.data() + static_cast<std::size_t>(yaw + half_yaws_) * count_, count_};
  }

  const LikelihoodPyramid* likelihood_ = nullptr;
  std::vector<Eigen::Vector2i> cells_;  // of the points at every angle
  std::size_t count_ = 0;
  int half_cells_ = 0, half_yaws_ = 0;
  double yaw_step_rad_ = 0.0;
  double centre_share_ = 0.0;
  int looks_left_ = 0;
  Node best_{};
};

}  // namespace slamd
