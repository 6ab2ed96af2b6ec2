#pragma once
// A pose sample as the JSON of the protocol. One direction only.

#include <nlohmann/json.hpp>

#include "daemon/server/protocol/pose_page.hpp"

namespace slamd {

/// The object that get_pose and the topic "pose" give; protocol/README.md documents each field.
nlohmann::json pose_json(const PoseSample& sample);

/// The names of the reasons, in order of their bits.
nlohmann::json reason_names(std::uint32_t reasons);

}  // namespace slamd
