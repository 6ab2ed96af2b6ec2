#pragma once
// What the search for loops and the recognition of places are set to. Values alone.

#include "estimator/graph/free_space.hpp"
#include "estimator/graph/keyframe_clouds.hpp"
#include "estimator/graph/submap_registration.hpp"

namespace slamd {

struct LoopCloserConfig {
  KeyframeCloudsConfig clouds;
  SubmapRegistrationConfig registration;
  FreeSpaceConfig free_space;
  double radius_m = 20.0;                 // grows with the uncertainty of the pose
  std::uint32_t min_keyframes_back = 8;
  double min_detour_m = 20.0;             // driven in between, beyond three times the straight way: else it is no loop
  // Half the cube of the odometry's own map (set by the configuration from PlaneMapConfig::max_distance_m): a place that never
  // left it is still in that map, and the odometry has closed the loop itself, unless it lost its way by more than this sigma.
  double local_map_reach_m = 110.0;
  double max_held_sigma_m = 0.2;
  std::uint32_t search_every = 4;         // keyframes
  std::uint32_t keyframes_ahead = 4;      // that a place waits for, so that its sub-map is round
  std::uint32_t keyframes_behind = 8;
  std::uint32_t candidates_by_appearance = 2;
  double max_descriptor_distance = 0.6;
  double min_search_score = 0.35;         // of the view from above
  double max_runner_up = 0.92;            // of the best score: beyond, the place repeats itself
  double min_fitness = 0.5;
  double min_overlap = 0.4;
  double max_free_space_share = 0.06;
  double max_chi2 = 22.46;                // 6 degrees of freedom, 99.9 %
};

}  // namespace slamd
