#pragma once
// A ROS 1 bag (format 2.0) as a bag. Older formats are refused.

#include "tools/slam-replay/bag/bag.hpp"

namespace slamd::replay {

OpenedBag open_ros1_bag(const std::string& path);

}  // namespace slamd::replay
