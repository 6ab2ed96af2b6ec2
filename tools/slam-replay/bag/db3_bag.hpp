#pragma once
// The SQLite files of a ROS 2 bag (.db3) as a bag. It reads no metadata.yaml (bag.cpp).

#include "tools/slam-replay/bag/bag.hpp"

namespace slamd::replay {

/// paths  the parts of one bag, in their order
OpenedBag open_db3(const std::vector<std::string>& paths);

}  // namespace slamd::replay
