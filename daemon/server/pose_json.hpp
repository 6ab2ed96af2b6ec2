#pragma once
// A pose sample as the JSON of the protocol. One direction only.

#include <nlohmann/json.hpp>
#include <string>

#include "daemon/server/protocol/pose_page.hpp"

namespace slamd {

/// The object that get_pose and the topic "pose" give, as text; docs/protocol.md documents each field. Written two hundred times a
/// second while fifty subscribers wait: a fifth of the time that a tree of JSON takes.
std::string pose_text(const PoseSample& sample);

/// The names of the reasons, in order of their bits.
nlohmann::json reason_names(std::uint32_t reasons);

}  // namespace slamd
