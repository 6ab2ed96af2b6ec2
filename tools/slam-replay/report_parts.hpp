#pragma once
// Pieces that the reports of both replays, in space and in the plane, are made of. Neither report is here.

#include <nlohmann/json.hpp>
#include <vector>

#include "tools/slam-replay/report.hpp"

namespace slamd::replay {

using Json = nlohmann::ordered_json;

/// {"p50", "p90", "p99", "p999", "max"}.
Json milliseconds(const Histogram& histogram);
/// [{"t_s", "status", "reasons"}].
Json status_line(const std::vector<StatusChange>& changes);
/// {group: {cause: count}} of all sensors of the recording; null when there is nothing.
Json stream_rejections(const Sensors& sensors);

}  // namespace slamd::replay
