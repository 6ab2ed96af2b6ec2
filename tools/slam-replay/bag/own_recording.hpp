#pragma once
// A recording that slamd made as MCAP (`slamctl record`, `slamd --record FILE.mcap`): its raw reads through the drivers, as those of a
// recorded drive folder, so that a replay has the same bits. Its channels of values are left alone.

#include <optional>
#include <string>

#include "tools/slam-replay/drive/sensors.hpp"

namespace slamd::replay {

/// Whether path is such a recording.
bool is_own_recording(const std::string& path);

/// Of such a recording.
Sensors open_own_recording(const std::string& path, const DriverConfigs& drivers);

/// The configuration that was in force; nothing when it is not there or damaged.
std::optional<std::string> recorded_config(const std::string& path);

}  // namespace slamd::replay
