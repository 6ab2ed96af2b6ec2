#pragma once
// Do the rays of one sub-map pass through surfaces of another? Two places that only look alike give themselves away so.

#include "estimator/graph/keyframe_clouds.hpp"
#include "estimator/map/plane_map.hpp"

namespace slamd {

struct FreeSpaceConfig {
  std::uint32_t max_rays = 800;    // evenly chosen
  float step_m = 0.4F;
  float margin_m = 1.0F;            // a ray must go on so far behind the surface, and begin so far before it
  float min_incidence = 0.4F;       // cosine between ray and normal: grazing rays prove nothing
};

struct FreeSpaceCheck {
  std::uint32_t rays = 0;          // that ran through seen space at all
  std::uint32_t contradicted = 0;  // of these, that passed through a surface
  double share() const { return rays == 0 ? 0.0 : static_cast<double>(contradicted) / static_cast<double>(rays); }
};

/// Walks along rays of `source` through the surfaces of `target`.
FreeSpaceCheck check_free_space(PlaneMap& target, const Submap& source, const Pose& T_target_source,
                                const FreeSpaceConfig& config = {});

}  // namespace slamd
