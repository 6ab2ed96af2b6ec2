#pragma once
// The definitions of the messages that slamd records, in ROS's own language, as MCAP's schema encoding "ros2msg" wants them: each with all
// that it is made of. It serialises nothing.

#include <string>
#include <string_view>

namespace slamd {

/// type  "sensor_msgs/msg/Imu", one of those that compose.hpp makes. Empty for any other.
std::string ros2_schema(std::string_view type);

}  // namespace slamd
