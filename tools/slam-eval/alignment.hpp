#pragma once
// The transform that lays an estimated trajectory over the truth. It changes poses, it measures nothing.

#include <cstddef>
#include <vector>

#include "estimator/types/pose.hpp"

namespace slamd::eval {

enum class Alignment {
  kNone,
  kSe3Umeyama,   // least squares over all positions, rotation and translation
  kSim3Umeyama,  // the same with scale
  kOrigin,       // first pose onto first pose
};

/// "none", "se3_umeyama", "sim3_umeyama", "origin".
const char* name(Alignment alignment);

/// p_truth = scale * R * p_estimate + t.
struct Similarity {
  Pose T_truth_estimate;
  double scale = 1.0;
};

/// Fits over the first `count` poses (0 = all) of equally long lists. Throws InputError when the positions do not fix a
/// rotation (fewer than 3, or all on one line), as they do for a vehicle that never moved.
/// Source: Umeyama 1991, eq. (34)-(43).
Similarity fit(Alignment alignment, const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
               std::size_t count = 0);

/// The poses in the truth's frame.
std::vector<Pose> aligned(const Similarity& similarity, const std::vector<Pose>& poses);

}  // namespace slamd::eval
