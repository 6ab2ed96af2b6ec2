#pragma once
// Finds a scan again in a map of an earlier run, near a place where the vehicle is believed to be. It says nothing of places
// that look alike farther away: the window keeps them out.

#include <optional>

#include "estimator/grid/correlative_matcher.hpp"
#include "estimator/grid/planar_scan.hpp"

namespace slamd {

struct PlanarRelocaliserConfig {
  LikelihoodConfig likelihood{.cell_m = 0.025, .sigma_m = 0.06, .levels = 5};
  double reach_m = 30.0;       // keyframes so near to the place count
  double least_half_m = 0.75;  // half width of the search for a vehicle that stood still,
  double way_share = 0.3;      // and more of it by this share of the way that it is believed to have gone unseen,
  double most_half_m = 3.0;    // but not so far that a place that looks alike could be meant
  double half_rad = 0.35;
  double least_score = 0.65;   // of a match that is believed, 0..1
  std::size_t points = 300;    // of a scan, at most
};

class PlanarRelocaliser {
 public:
  explicit PlanarRelocaliser(const PlanarRelocaliserConfig& config) : config_{config}, likelihood_{config.likelihood} {}

  /// A keyframe of the map. Only those within reach of the place are to be given.
  void add(const PlanarScan& scan, const PlanarPose& T_map_base) { likelihood_.add(scan.points, T_map_base); }
  double reach_m() const { return config_.reach_m; }

  /// Where the scan was taken; nothing when it fits nowhere near the place. unseen_m: way that is only believed. Some milliseconds.
  std::optional<CorrelativeMatch> look(const PlanarScan& scan, const PlanarPose& T_map_believed, double unseen_m);

 private:
  PlanarRelocaliserConfig config_;
  LikelihoodPyramid likelihood_;
  CorrelativeMatcher matcher_;
  std::vector<Eigen::Vector2f> sample_;
};

}  // namespace slamd
