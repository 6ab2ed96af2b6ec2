#pragma once
// Writes wire events as a drive folder: lidar.pcap, imu.csv, gps.csv, truth.tum, vehicle.yaml. Design, section 8. On request
// the serial bytes as they are (imu.pcap, gps.pcap) in place of the two tables.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "drivers/io/pcap_sink.hpp"
#include "tools/slam-sim/sensors/simulation.hpp"

namespace slamd::sim {

class DriveFolder {
 public:
  /// Creates the folder; a sensor's file appears with its first event. host_start_ns: host time of the start of the
  /// drive. Throws std::runtime_error with path and reason.
  DriveFolder(const std::filesystem::path& folder, std::int64_t host_start_ns, bool serial_bytes = false);

  /// Events in order of arrival. IMU frames that a driver would refuse leave no line.
  void write(const WireEvent& event);
  /// truth.tum (base in world, 100 Hz) and vehicle.yaml.
  void write_truth(const Trajectory& trajectory, double duration_s);
  void write_vehicle(const VehicleGeometry& vehicle);

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  static File open(const std::filesystem::path& path);
  void write_bytes(const WireEvent& event, std::uint16_t port, const char* name, std::optional<PcapSink>& file);
  void write_imu(const WireEvent& event);
  void write_gps(const WireEvent& event);

  std::filesystem::path folder_;
  std::int64_t host_start_ns_;
  bool serial_bytes_;
  std::optional<PcapSink> lidar_, imu_bytes_, gps_bytes_;
  File imu_;
  File gps_;
};

/// One line of a TUM file.
void write_tum_line(std::FILE* file, std::int64_t stamp_ns, const Pose& pose);

}  // namespace slamd::sim
