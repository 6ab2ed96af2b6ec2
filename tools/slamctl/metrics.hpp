#pragma once
// get_status in Prometheus' text exposition format 0.0.4, for the textfile collector of node_exporter. Sends nothing.

#include <nlohmann/json.hpp>
#include <string>

namespace slamd::slamctl {

/// Seconds, bytes and hertz; totals since the daemon's start end in _total. What the daemon does not know (null) is left
/// out. Throws json's exceptions where `status` is not what the protocol says.
std::string metrics_text(const nlohmann::json& status);

}  // namespace slamd::slamctl
