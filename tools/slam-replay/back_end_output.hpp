#pragma once
// The files of the back end, written when the drive is over: map.tum, enu.tum, closures.csv, gps.csv. The map itself is main.cpp's.

#include <string>

#include "tools/slam-replay/replay.hpp"

namespace slamd::replay {

/// Into `folder`, which is there. enu.tum only when GPS was used. False when anything could not be written.
bool write_back_end(const Replay& replay, const std::string& folder);

}  // namespace slamd::replay
