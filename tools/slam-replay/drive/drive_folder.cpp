#include "tools/slam-replay/drive/drive_folder.hpp"

#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include "tools/slam-replay/drive/table_streams.hpp"
#include "tools/slam-replay/drive/wire_streams.hpp"

namespace slamd::replay {
namespace {

std::unique_ptr<ReadSource> open_capture(const std::string& path) {
  Result<PcapSource> capture = PcapSource::open(path.c_str());
  if (!capture) return nullptr;
  return std::make_unique<PcapReads>(std::move(capture).value());
}

/// The IMU that is built into an Airy.
std::unique_ptr<Stream<ImuSample>> open_airy_imu(const std::string& path, const DriverConfigs& config) {
  Result<PcapSource> capture = PcapSource::open(path.c_str());
  if (!capture) return nullptr;
  return std::make_unique<AiryImuStream>(std::make_unique<PortReads>(std::move(capture).value(), config.lidar.ports.imu), config.airy_imu);
}

/// name.pcap when it is there, else name.csv, else nothing.
template <class Wire, class Table, class Item, class WireConfig, class TableConfig>
std::unique_ptr<Stream<Item>> open(const std::string& name, const WireConfig& wire, const TableConfig& table) {
  if (std::unique_ptr<ReadSource> reads = open_capture(name + ".pcap")) return std::make_unique<Wire>(std::move(reads), wire);
  if (!std::filesystem::exists(name + ".csv")) return nullptr;
  return std::make_unique<Table>(name + ".csv", table);
}

std::map<HostTime, double> read_shares(const std::string& path) {
  std::map<HostTime, double> shares;
  std::ifstream file{path};
  file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');  // the header
  std::int64_t end_ns = 0;
  char comma = ',';
  for (double share = 1.0; file >> end_ns >> comma >> share;) {
    if (share >= 0.0 && share <= 1.0) shares[from_ns<HostTime>(end_ns)] = share;
  }
  return shares;
}

}  // namespace

std::unique_ptr<Stream<LidarPacket>> lidar_stream(std::unique_ptr<ReadSource> reads, const DriverConfigs& config) {
  return std::make_unique<SpinningStream>(std::move(reads), config.lidar);
}

std::unique_ptr<Stream<LidarPacket>> open_lidar_capture(const std::string& path, const DriverConfigs& config) {
  std::unique_ptr<ReadSource> reads = open_capture(path);
  return reads == nullptr ? nullptr : lidar_stream(std::move(reads), config);
}

Sensors open_drive_folder(const std::string& folder, const DriverConfigs& config) {
  Sensors sensors;
  sensors.lidar = open_lidar_capture(folder + "/lidar.pcap", config);
  sensors.imu = open<ImuWireStream, ImuTableStream, ImuSample>(folder + "/imu", config.imu_frames, config.imu_clock);
  if (!sensors.imu && config.lidar.model == LidarModel::kAiry) sensors.imu = open_airy_imu(folder + "/lidar.pcap", config);
  sensors.gnss = open<GnssWireStream, GpsTableStream, GnssFix>(folder + "/gps", config.nmea, config.nmea);
  if (std::unique_ptr<ReadSource> reads = open_capture(folder + "/wheel.pcap"))
    sensors.wheel = std::make_unique<WheelWireStream>(std::move(reads), WheelTrackConfig::defaults());
  if (!sensors.wheel && std::filesystem::exists(folder + "/wheel.csv"))
    sensors.wheel = std::make_unique<WheelTableStream>(folder + "/wheel.csv", WheelTrackConfig::defaults());
  if (std::unique_ptr<ReadSource> reads = open_capture(folder + "/rplidar.pcap"); reads && !sensors.lidar)
    sensors.laser = std::make_unique<RplidarWireStream>(std::move(reads), config.rplidar);
  if (!sensors.lidar && !sensors.laser && std::filesystem::exists(folder + "/scan.csv")) sensors.laser = std::make_unique<ScanTableStream>(folder + "/scan.csv");
  sensors.scan_shares = read_shares(folder + "/scan_shares.csv");
  return sensors;
}

}  // namespace slamd::replay
