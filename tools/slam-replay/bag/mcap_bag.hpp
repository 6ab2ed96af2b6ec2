#pragma once
// An MCAP file as a bag: ROS 2 (cdr) and ROS 1 (ros1) messages, and slamd's own recordings.

#include "tools/slam-replay/bag/bag.hpp"
#include "tools/slam-replay/bag/mapped_file.hpp"

namespace slamd::replay {

OpenedBag open_mcap(const std::string& path);

}  // namespace slamd::replay
