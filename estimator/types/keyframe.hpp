#pragma once
// What the front end hands to the mapping thread every few metres. Not corrected: the back end owns corrections.

#include <cstdint>

#include "estimator/types/nav_state.hpp"
#include "estimator/types/point_cloud.hpp"

namespace slamd {

struct Keyframe {
  std::uint64_t id = 0;  // counts from 0 without gaps
  NavState state;        // at the scan's end
  PointCloud points;     // de-skewed to state.time, base frame
};

}  // namespace slamd
