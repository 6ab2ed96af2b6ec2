#pragma once
// The files of a drive folder as streams. It merges nothing, and it is not for bags (tools/slam-replay/bag).

#include <string>

#include "tools/slam-replay/drive/read_source.hpp"
#include "tools/slam-replay/drive/sensors.hpp"

namespace slamd::replay {

/// Any of lidar.pcap (or scan.csv in its place), imu.csv, gps.csv, wheel.csv may be missing. Of a recording of slamd there are imu.pcap and gps.pcap instead, the
/// bytes of the serial ports: with them every event is as it was live, to the last bit.
Sensors open_drive_folder(const std::string& folder, const DriverConfigs& config);

/// Datagrams of the LiDAR through its driver.
std::unique_ptr<Stream<LidarPacket>> lidar_stream(std::unique_ptr<ReadSource> reads, const DriverConfigs& config);

/// lidar.pcap on its own: a capture of the LiDAR's datagrams. Null when it cannot be read.
std::unique_ptr<Stream<LidarPacket>> open_lidar_capture(const std::string& path, const DriverConfigs& config);

}  // namespace slamd::replay
