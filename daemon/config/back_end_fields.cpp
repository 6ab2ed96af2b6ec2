#include "daemon/config/back_end_fields.hpp"

namespace slamd {

std::vector<Field> back_end_fields(BackEndConfig& c) {
  MapGraphConfig& graph = c.mapper.graph;
  RelocaliserConfig& again = c.relocaliser;
  return {
      {"relocalisation.confirm_m", &again.confirm_m, "m", {0, 100},
       "a place found by looks alone counts when another one, so far on, says the same"},
      {"relocalisation.patience_m", &again.patience_m, "m", {1, 1e5},
       "driven after being lost without finding the map again; then a new one begins"},
      {"graph.use_loops", &c.use_loops, "", {}, "search for places seen before and close loops"},
      {"graph.cloud_byte_budget", &c.loops.clouds.byte_budget, "B", {1U << 16U, 1e12},
       "of the points for closing loops; beyond it no loop is closed with the oldest keyframes"},
      {"graph.byte_budget", &c.mapper.byte_budget, "B", {1U << 16U, 1e12},
       "of all else that grows; beyond it the map is corrected no further, and odometry alone carries on"},
      {"graph.use_gps", &c.use_gps, "", {}, "align the map in ENU, and correct it where GPS contradicts it"},
      {"graph.gravity_sigma_rad", &graph.gravity_sigma_rad, "rad", {1e-4, 1}, "of a keyframe's direction of gravity, at least"},
      {"graph.gravity_correlation", &graph.gravity_correlation, "", {1, 1e4}, "keyframes that share one error of gravity"},
      {"graph.closure_phi", &graph.closure_phi, "", {0.1, 1e4}, "chi2 of a closure from which on it counts less"},
      {"graph.closure_correlation", &graph.closure_correlation, "", {1, 100}, "neighbouring closures that share one error"},
      {"graph.position_phi", &graph.position_phi, "", {0.1, 1e4}, "likewise of a GPS position"},
      {"graph.max_iterations", &c.mapper.max_iterations, "", {1, 1000}, "of one solve"},
      {"graph.closure_growth", &c.mapper.closure_growth, "", {0, 10},
       "share by which the drive grows between two solves that closures or GPS ask for"},
      {"graph.resolve_growth", &c.mapper.resolve_growth, "", {0.01, 10},
       "share by which the drive grows before gravity alone is solved for"},
  };
}

}  // namespace slamd
