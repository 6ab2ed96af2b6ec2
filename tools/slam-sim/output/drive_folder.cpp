#include "tools/slam-sim/output/drive_folder.hpp"

#include <array>
#include <cinttypes>
#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "firmware/protocol/imu_frame.hpp"
#include "tools/slam-sim/sensors/rplidar_device.hpp"

namespace slamd::sim {
namespace {

std::filesystem::path created(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error(folder.string() + ": " + error.message());
  return folder;
}

}  // namespace

void write_tum_line(std::FILE* file, std::int64_t stamp_ns, const Pose& pose) {
  const auto& p = pose.translation;
  const auto& q = pose.rotation;
  std::fprintf(file, "%" PRId64 ".%09" PRId64 " %.9f %.9f %.9f %.12f %.12f %.12f %.12f\n", stamp_ns / 1'000'000'000,
               stamp_ns % 1'000'000'000, p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

DriveFolder::File DriveFolder::open(const std::filesystem::path& path) {
  File file{std::fopen(path.c_str(), "w"), &std::fclose};
  if (!file) throw std::runtime_error(path.string() + ": " + std::strerror(errno));
  return file;
}

DriveFolder::DriveFolder(const std::filesystem::path& folder, const FolderFormat& format)
    : folder_{created(folder)},
      format_{format},
      imu_{nullptr, &std::fclose},
      gps_{nullptr, &std::fclose},
      wheel_{nullptr, &std::fclose},
      scan_{nullptr, &std::fclose} {
  for (const char* name : {"lidar.pcap", "rplidar.pcap", "scan.csv", "imu.csv", "gps.csv", "imu.pcap", "gps.pcap", "wheel.csv"})
    std::filesystem::remove(folder_ / name);
}

void DriveFolder::write(const WireEvent& event) {
  switch (event.channel) {
    case Channel::kLidar:
      write_lidar(event);
      break;
    case Channel::kPosition:
      write_bytes(event, ports_of(format_.lidar).side, "lidar.pcap", lidar_);
      break;
    case Channel::kLidarImu:
      write_bytes(event, ports_of(format_.lidar).imu, "lidar.pcap", lidar_);
      break;
    case Channel::kImu:
      format_.serial_bytes ? write_bytes(event, 0, "imu.pcap", imu_bytes_) : write_imu(event);
      break;
    case Channel::kGps:
      format_.serial_bytes ? write_bytes(event, 0, "gps.pcap", gps_bytes_) : write_line(event, "gps.csv", "t_ns,sentence", gps_);
      break;
    case Channel::kWheel:
      write_line(event, "wheel.csv", "t_ns,sentence", wheel_);
      break;
  }
}

/// As the sensor sends: a broadcast from 192.168.1.201, both ports alike.
void DriveFolder::write_bytes(const WireEvent& event, std::uint16_t port, const char* name,
                              std::optional<PcapSink>& file) {
  constexpr std::array<std::uint8_t, 4> kFactoryAddress{192, 168, 1, 201};
  if (!file) {
    const std::filesystem::path path = folder_ / name;
    Result<PcapSink> sink = PcapSink::open(path.c_str());
    if (!sink) throw std::runtime_error(path.string() + ": " + sink.reason());
    file = std::move(sink).value();
  }
  file->write({event.bytes, from_ns<HostTime>(format_.host_start_ns + event.arrival_ns), ipv4_address(kFactoryAddress), port, port});
}

/// An RPLIDAR's stream begins with what it had answered before.
void DriveFolder::write_lidar(const WireEvent& event) {
  if (format_.lidar == LidarKind::kLaserScan)
    return write_line(event, "scan.csv", "t_ns,angle_begin_rad,angle_step_rad,beam_s,range_max_m,ranges_m", scan_);
  if (format_.lidar != LidarKind::kRplidarA2) return write_bytes(event, ports_of(format_.lidar).points, "lidar.pcap", lidar_);
  if (!lidar_) {
    WireEvent greeting = event;
    greeting.bytes = rplidar_greeting(format_.rplidar);
    write_bytes(greeting, 0, "rplidar.pcap", lidar_);
  }
  write_bytes(event, 0, "rplidar.pcap", lidar_);
}

void DriveFolder::write_imu(const WireEvent& event) {
  const auto decoded = decode_imu_packet(std::span<const std::uint8_t>{event.bytes}.first(kImuFramePacketBytes));
  if (!decoded) return;
  if (!imu_) {
    imu_ = open(folder_ / "imu.csv");
    std::fputs("t_ns,gx_rads,gy_rads,gz_rads,ax_mps2,ay_mps2,az_mps2,temp_c\n", imu_.get());
  }
  constexpr double kGyro = kImuGyroMdpsPerLsb * 1e-3 * std::numbers::pi / 180.0;
  constexpr double kAccel = kImuAccelMgPerLsb * 1e-3 * 9.80665;
  std::fprintf(imu_.get(), "%" PRId64, format_.host_start_ns + event.arrival_ns);
  for (const auto counts : decoded.frame.gyro) std::fprintf(imu_.get(), ",%.8f", counts * kGyro);
  for (const auto counts : decoded.frame.accel) std::fprintf(imu_.get(), ",%.8f", counts * kAccel);
  std::fprintf(imu_.get(), ",%.2f\n", decoded.frame.temperature / kImuTemperatureLsbPerC + kImuTemperatureZeroC);
}

/// One line an event, whatever its bytes: line ends inside (damaged sentences) would break the file and become dots.
void DriveFolder::write_line(const WireEvent& event, const char* name, const char* header, File& file) {
  if (!file) {
    file = open(folder_ / name);
    std::fprintf(file.get(), "%s\n", header);
  }
  std::string text(event.bytes.begin(), event.bytes.end());
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  for (char& c : text) {
    if (c == '\n' || c == '\r' || c == '\0') c = '.';
  }
  std::fprintf(file.get(), "%" PRId64 ",%s\n", format_.host_start_ns + event.arrival_ns, text.c_str());
}

void DriveFolder::write_truth(const Trajectory& trajectory, double duration_s) {
  const File file = open(folder_ / "truth.tum");
  const auto count = static_cast<std::int64_t>(std::floor(duration_s * 100.0 + 1e-6));
  for (std::int64_t i = 0; i <= count; ++i) {
    write_tum_line(file.get(), format_.host_start_ns + i * 10'000'000, trajectory.pose_at(static_cast<double>(i) * 0.01));
  }
}

void DriveFolder::write_vehicle(const VehicleGeometry& vehicle) {
  const File file = open(folder_ / "vehicle.yaml");
  const auto transform = [&](const char* name, const Pose& pose) {
    const auto& p = pose.translation;
    const auto& q = pose.rotation;
    std::fprintf(file.get(),
                 "%s:\n  translation_m: [%.6f, %.6f, %.6f]\n  rotation_quat_xyzw: [%.12f, %.12f, %.12f, %.12f]\n", name,
                 p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  };
  std::fputs(
      "# True extrinsics: p_base = T_base_x * p_x, metres. base: footprint on the ground, x forward, y left, z up.\n",
      file.get());
  transform("T_base_lidar", vehicle.T_base_lidar);
  transform("T_base_imu", vehicle.T_base_imu);
  const auto& a = vehicle.p_base_antenna;
  std::fprintf(file.get(), "p_base_antenna: [%.6f, %.6f, %.6f]\n", a.x(), a.y(), a.z());
  std::fprintf(file.get(), "lidar_model: %s\n", name(format_.lidar));
  if (format_.lidar == LidarKind::kVlp16)
    std::fputs("# The LiDAR's rays begin at the heights of the manual, not at one point.\nlidar_vertical_offsets: true\n", file.get());
}

}  // namespace slamd::sim
