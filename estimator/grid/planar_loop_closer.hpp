#pragma once
// Has the vehicle been here before, and where exactly: the newest stretch of the drive against the map of an older one, by
// branch and bound, refined on lines, judged. What follows for the map is planar_graph's.

#include <optional>
#include <vector>

#include "estimator/grid/correlative_matcher.hpp"
#include "estimator/grid/line_matcher.hpp"
#include "estimator/grid/planar_node.hpp"

namespace slamd {

struct PlanarLoopConfig {
  double stretch_m = 4.0;          // of the drive, that is looked up at once, to the newest keyframe
  double reach_m = 8.0;            // of the older drive that makes the map, to both sides of the candidate
  double least_way_m = 15.0;       // driven since the candidate, at least: what is newer is in the odometry's own map
  double least_way_ranges = 6.0;   // likewise in mean ranges of the scan
  double reach_ranges = 1.0;       // stretch and reach grow with the mean range likewise
  double radius_m = 4.0;           // candidates so near are looked at in any case, and
  double sigmas = 3.0;             // as far as the odometry may have drifted
  double most_radius_m = 15.0;
  double most_yaw_rad = 0.6;
  std::size_t search_points = 300;
  int search_looks = 200'000;
  double least_score = 0.35;        // of the search
  double least_inlier_share = 0.4; // of the refined match, and
  double least_own_share = 0.75;   // of what the newest scan had in the odometry's own map
  double most_mean_square = 4.0;
  double floor_sigma_m = 0.005;    // of a closure: what two stretches themselves err by
  double floor_sigma_rad = 0.0007;
  double gate_sigmas = 4.0;        // closures that odometry holds for impossible
};

class PlanarLoopCloser {
 public:
  PlanarLoopCloser(const PlanarLoopConfig& config, const LineMapConfig& lines, const LikelihoodConfig& likelihood,
                   const LineMatcherConfig& matcher);

  /// Looks for the place of the newest node of `nodes[0 .. newest]` among the older ones; nothing when it is not found or not
  /// believed. Takes 10 to 300 ms.
  std::optional<PlanarClosure> look(const PlanarNodes& nodes, std::size_t newest);

 private:
  std::optional<std::size_t> candidate(const PlanarNodes& nodes, std::size_t newest) const;
  void build_map(const PlanarNodes& nodes, std::size_t middle, std::size_t end);
  PlanarScan stretch(const PlanarNodes& nodes, std::size_t newest) const;
  Eigen::Matrix3d drift(const PlanarNodes& nodes, std::size_t from, std::size_t to) const;
  std::optional<PlanarPose> search(const PlanarScan& scan, const PlanarPose& guess, const Eigen::Matrix3d& drift);

  PlanarLoopConfig config_;
  LineMatcherConfig matcher_;
  LineMap lines_;
  LikelihoodPyramid likelihood_;
  CorrelativeMatcher correlative_;
};

}  // namespace slamd
