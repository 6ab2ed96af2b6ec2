#pragma once
// What get_status says of the back end: the newest solution, and what it thinks of GPS. Moves nothing.

#include <cstddef>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "estimator/graph/relocaliser.hpp"

namespace slamd {

/// What the back end thinks of GPS.
struct GnssState {
  GnssTrust trust = GnssTrust::kAbsent;
  GnssLatency latency;  // on top of gnss.latency_s
};

struct BackEndState {
  std::shared_ptr<const GraphSolution> solution = std::make_shared<GraphSolution>();  // never null
  std::optional<GnssState> gnss;    // none: the back end does not use GPS
  MapLink link;
  RelocaliserCounts relocalisation;
  std::size_t forgotten_clouds = 0; // keyframes that no loop can be closed with any more
  std::size_t bytes = 0;            // of all that grows but points
  std::size_t byte_budget = 0;
  std::uint64_t left_out_keyframes = 0;  // for this budget; more than none: the map is corrected no further
};

/// Mapping thread. now  host time.
BackEndState state_of(const Relocaliser& back_end, HostTime now);

nlohmann::json to_json(const BackEndState& state);

}  // namespace slamd
