#pragma once
// What slamctl shows to people: status and poses of the protocol as text. Prints nothing itself.

#include <nlohmann/json.hpp>
#include <string>

namespace slamd::slamctl {

/// printf into a string, at most 511 characters.
[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);
/// A number, or nan where the daemon had none to give (null).
double number(const nlohmann::json& object, const char* key);
/// A list of texts with blanks between.
std::string joined(const nlohmann::json& names);
/// Of a sensor: "healthy", "faulty (silent)".
std::string state_text(const nlohmann::json& source);

/// Several lines: status with reasons, sources, stages, rings, map, server.
std::string status_text(const nlohmann::json& status);

/// One line: time, status, position, heading, speed, sigma, reasons.
std::string pose_text(const nlohmann::json& pose);

}  // namespace slamd::slamctl
