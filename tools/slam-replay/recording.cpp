#include "tools/slam-replay/recording.hpp"

#include <filesystem>

#include "tools/slam-replay/bag/own_recording.hpp"
#include "tools/slam-replay/drive/carmen_log.hpp"
#include "tools/slam-replay/drive/drive_folder.hpp"

namespace slamd::replay {
namespace {

Recording open_bag_recording(const std::string& path, const TopicWishes& wishes, const DriverConfigs& drivers) {
  OpenedBag opened = open_bag(path);
  if (const auto* fault = std::get_if<std::string>(&opened)) return {.fault = *fault};
  const Bag& bag = *std::get<std::unique_ptr<Bag>>(opened);
  BagSensors found = open_sensors(bag, wishes, drivers);
  if (!found.fault.empty()) return {.fault = path + ": " + found.fault};
  return {.sensors = std::move(found.sensors), .notes = std::move(found.notes)};
}

/// A CARMEN log brings its vehicle along: a laser that looks forwards, level, somewhere on its axis.
Recording open_carmen_recording(const std::string& path) {
  Recording recording;
  CarmenLog log = read_carmen_log(path);
  recording.notes = log.faults;
  recording.T_base_lidar = Pose{Eigen::Quaterniond::Identity(), {log.laser_forward_m, 0.0, 0.0}};
  recording.sensors = sensors_of(std::move(log));
  return recording;
}

bool is_empty(const Sensors& sensors) { return !sensors.lidar && !sensors.imu && !sensors.laser; }

}  // namespace

Recording open_recording(const std::string& path, const TopicWishes& wishes, const DriverConfigs& drivers) {
  std::error_code error;
  Recording recording;
  if (wishes.empty() && is_own_recording(path)) {
    recording.sensors = open_own_recording(path, drivers);
  } else if (is_bag(path)) {
    recording = open_bag_recording(path, wishes, drivers);
  } else if (std::filesystem::is_directory(path, error)) {
    recording.sensors = open_drive_folder(path, drivers);
  } else if (std::filesystem::exists(path, error) && is_carmen_name(path)) {
    recording = open_carmen_recording(path);
  } else if (std::filesystem::exists(path, error)) {
    recording.sensors.lidar = open_lidar_capture(path, drivers);
    if (!recording.sensors.lidar) recording.fault = path + ": is neither a bag, a drive folder nor a capture (pcap, pcapng)";
  } else {
    recording.fault = path + ": is not there";
  }
  if (recording.fault.empty() && is_empty(recording.sensors)) {
    recording.fault = recording.notes.empty() ? path + ": has no LiDAR, IMU or laser scans that can be read" : recording.notes.front();
  }
  return recording;
}

std::string list_recording(const std::string& path, const TopicWishes& wishes, std::string& fault) {
  if (is_bag(path)) {
    OpenedBag opened = open_bag(path);
    if (auto* reason = std::get_if<std::string>(&opened)) {
      fault = *reason;
      return {};
    }
    return list_text(path, *std::get<std::unique_ptr<Bag>>(opened), wishes);
  }
  const Recording recording = open_recording(path, wishes, {});
  fault = recording.fault;
  std::string text = path + ": drive folder, log or capture:";
  const auto name = [&text](const auto& stream, const char* sensor) {
    if (stream) text += std::string{" "} + sensor;
  };
  name(recording.sensors.lidar, "lidar");
  name(recording.sensors.imu, "imu");
  name(recording.sensors.gnss, "gps");
  name(recording.sensors.wheel, "odometry");
  name(recording.sensors.laser, "scan");
  return text + "\n";
}

std::string missing_line(const Sensors& sensors) {
  std::string line;
  const auto add = [&line](bool is_there, const char* text) {
    if (!is_there) line += (line.empty() ? "" : "; ") + std::string{text};
  };
  add(sensors.lidar || sensors.laser, "no LiDAR: the IMU alone gives no pose");
  add(sensors.imu != nullptr, "no IMU: the LiDAR alone");
  add(sensors.gnss != nullptr, "no GPS: no place on the earth");
  return line;
}

std::string folder_of(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return path;
  const std::string parent = std::filesystem::path{path}.parent_path().string();
  return parent.empty() ? "." : parent;
}

}  // namespace slamd::replay
