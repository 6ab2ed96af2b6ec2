#pragma once
// Opens a recording whatever its form: drive folder, bag, capture. The one place that knows them all.

#include <optional>
#include <string>
#include <vector>

#include "estimator/types/pose.hpp"
#include "tools/slam-replay/bag/bag_sensors.hpp"
#include "tools/slam-replay/drive/sensors.hpp"

namespace slamd::replay {

struct Recording {
  Sensors sensors{};
  std::optional<Pose> T_base_lidar{};  // where the recording itself says it
  std::vector<std::string> notes{};  // what whoever replays should know, a line each
  std::string fault{};               // why it cannot be replayed; empty: it can
};

/// path    a drive folder, a bag (open_bag), a CARMEN log, or a capture of the LiDAR's datagrams (pcap, pcapng)
/// wishes  of bags
Recording open_recording(const std::string& path, const TopicWishes& wishes, const DriverConfigs& drivers);

/// What is in it, as lines for people; a fault as Recording has it in `fault`.
std::string list_recording(const std::string& path, const TopicWishes& wishes, std::string& fault);

/// Which of the sensors are not there and what that means, in one line; empty when nothing is missing.
std::string missing_line(const Sensors& sensors);

/// The folder in which vehicle.yaml and slamd.yaml of the recording are looked for: its own, or the one that it lies in.
std::string folder_of(const std::string& path);

}  // namespace slamd::replay
