#pragma once
// Writes wire events as a drive folder: lidar.pcap, rplidar.pcap or scan.csv, imu.csv, gps.csv, wheel.csv, truth.tum, vehicle.yaml. Design,
// section 8. On request the serial bytes as they are (imu.pcap, gps.pcap) in place of the two tables.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "drivers/io/pcap_sink.hpp"
#include "tools/slam-sim/sensors/simulation.hpp"

namespace slamd::sim {

struct FolderFormat {
  std::int64_t host_start_ns = 0;  // host time of the start of the drive
  LidarKind lidar = LidarKind::kVlp16;
  RplidarFirmware rplidar = RplidarFirmware::kBoost;
  bool serial_bytes = false;
};

class DriveFolder {
 public:
  /// Creates the folder; a sensor's file appears with its first event. Throws std::runtime_error with path and reason.
  DriveFolder(const std::filesystem::path& folder, const FolderFormat& format);

  /// Events in order of arrival. IMU frames that a driver would refuse leave no line.
  void write(const WireEvent& event);
  /// truth.tum (base in world, 100 Hz) and vehicle.yaml.
  void write_truth(const Trajectory& trajectory, double duration_s);
  void write_vehicle(const VehicleGeometry& vehicle);

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  static File open(const std::filesystem::path& path);
  void write_bytes(const WireEvent& event, std::uint16_t port, const char* name, std::optional<PcapSink>& file);
  void write_lidar(const WireEvent& event);
  void write_imu(const WireEvent& event);
  void write_line(const WireEvent& event, const char* name, const char* header, File& file);

  std::filesystem::path folder_;
  FolderFormat format_;
  std::optional<PcapSink> lidar_, imu_bytes_, gps_bytes_;
  File imu_, gps_, wheel_, scan_;
};

/// One line of a TUM file.
void write_tum_line(std::FILE* file, std::int64_t stamp_ns, const Pose& pose);

}  // namespace slamd::sim
