#pragma once
// The turn about the vertical and the shift that lay the vehicle's own track on its fixes, and which fixes agree on it.
// No graph: the track is taken as rigid.

#include <optional>
#include <span>
#include <vector>

#include "estimator/graph/graph_solution.hpp"

namespace slamd {

/// One fix and where the map has the antenna then.
struct EnuPair {
  Eigen::Vector3d p_map;
  Eigen::Vector3d p_enu;
  Eigen::Vector3d sigma_m;  // east, north, up
  double share = 1.0;       // of an independent sample: errors that last for many fixes count once
};

struct EnuFitConfig {
  double correlation_s = 60.0;        // a receiver's errors last for so long: e^-1 of them is left after it
  double max_yaw_sigma_rad = 0.05;    // less sure: no alignment
  double min_inlier_share = 0.6;      // of the fixes; fewer: no alignment
  std::size_t min_fixes = 8;
};

struct EnuFit {
  EnuAlignment alignment;        // covariance: correlated errors counted once
  std::vector<bool> inlier;      // one a pair
  double inlier_share = 0.0;
};

/// The largest set of pairs that agree (within three sigma, horizontally), found by trying pairs far from each other in a
/// fixed order, then least squares over it, Cauchy-weighted. Null when it is no majority or the yaw is not known.
/// Source: Umeyama 1991 in the plane; Fischler, Bolles 1981.
std::optional<EnuFit> fit_enu(std::span<const EnuPair> pairs, const EnuFitConfig& config);

}  // namespace slamd
