#pragma once
// What slamctl shows to people: status and poses of the protocol as text. Prints nothing itself.

#include <nlohmann/json.hpp>
#include <string>

namespace slamd::slamctl {

/// Several lines: status with reasons, sources, stages, rings, map, server.
std::string status_text(const nlohmann::json& status);

/// One line: time, status, position, heading, speed, sigma, reasons.
std::string pose_text(const nlohmann::json& pose);

}  // namespace slamd::slamctl
