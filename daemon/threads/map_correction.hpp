#pragma once
// What a solution of the back end does to the map for clients. Shared by the mapping thread and slam-replay; no thread here.

#include "daemon/store/map_store.hpp"
#include "estimator/graph/graph_solution.hpp"

namespace slamd {

/// Moves the keyframes whose place has changed, and says where map lies on the earth.
void correct_map(const GraphSolution& solution, const GraphSolution& before, MapStore& map);

}  // namespace slamd
