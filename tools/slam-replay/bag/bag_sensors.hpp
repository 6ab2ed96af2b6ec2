#pragma once
// A bag as the sensors of a drive: which topic is which sensor, by type or as told, and a stream for each. It reads no container
// (bag.hpp) and merges nothing (tools/slam-replay/drive).

#include <map>
#include <string>
#include <vector>

#include "tools/slam-replay/bag/bag.hpp"
#include "tools/slam-replay/drive/sensors.hpp"

namespace slamd::replay {

/// The roles that a topic may have: "lidar", "imu", "gps", "odometry", "scan"; to a topic's name, or "" for none.
using TopicWishes = std::map<std::string, std::string>;

/// A topic and what it is taken for.
struct TopicUse {
  Topic topic;
  std::string role;  // "": left alone
};

/// Roles by type; of several topics that could have one the first by preference (raw packets before clouds) and then the one with the
/// most messages. Wishes win. Nothing that is wished for is replaced by something else.
std::vector<TopicUse> assign_roles(const std::vector<Topic>& topics, const TopicWishes& wishes);

struct BagSensors {
  Sensors sensors;
  std::vector<std::string> notes;  // what was found out about the topics, a line each
  std::string fault;               // why there are no sensors: a wish that cannot be met
};

BagSensors open_sensors(const Bag& bag, const TopicWishes& wishes, const DriverConfigs& drivers);

/// Topics with types, counts, roles; for people.
std::string list_text(const std::string& path, const Bag& bag, const TopicWishes& wishes);

}  // namespace slamd::replay
