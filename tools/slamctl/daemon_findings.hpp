#pragma once
// What a daemon's answer to get_status says is wrong with it, as findings of the doctor. Asks nobody itself.

#include <nlohmann/json.hpp>

#include "daemon/doctor/finding.hpp"

namespace slamd::slamctl {

/// The pose's status, every sensor that is configured, and losses between the daemon's threads. Throws json's exceptions
/// where `status` is not what the protocol says.
doctor::Findings daemon_findings(const nlohmann::json& status);

/// {"right": bool, "findings": [{"verdict", "subject", "found", "remedy"}]}
nlohmann::json findings_json(const doctor::Findings& findings);

}  // namespace slamd::slamctl
