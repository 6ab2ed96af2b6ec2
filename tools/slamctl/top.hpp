#pragma once
// `slamctl top`: two answers of get_status, some time apart, as rates and as a screen. Asks nobody and prints nothing
// itself.

#include <nlohmann/json.hpp>
#include <string>

namespace slamd::slamctl {

/// What happened between the two: {"interval_s", "pose_rate_hz", "cpu_percent": {thread}, "lost_per_s": {sensor},
/// "rejected_per_s": {sensor}, "dropped_per_s": {ring}}. Of what began anew in between (another daemon) the rate is zero.
/// Throws json's exceptions where a status is not what the protocol says.
nlohmann::json top_figures(const nlohmann::json& before, const nlohmann::json& after);

/// A screen of lines: pose, gates, sensors, stages, rings, threads, memory.
std::string top_text(const nlohmann::json& status, const nlohmann::json& figures);

}  // namespace slamd::slamctl
