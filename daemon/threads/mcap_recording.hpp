#pragma once
// One MCAP file that is being recorded: every read of the wires byte for byte with its stamp, and beside them what they say as ROS 2
// messages. It runs on the recorder's thread and decides neither when to begin nor when to end (mcap_recorder.hpp).

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/server/protocol/pose_page.hpp"
#include "daemon/threads/scan_budget.hpp"
#include "drivers/gnss/nmea_parser.hpp"
#include "drivers/imu/imu_frame_parser.hpp"
#include "drivers/io/udp_packet.hpp"
#include "drivers/lidar/lidar_model.hpp"
#include "drivers/lidar/spinning_lidar.hpp"
#include "drivers/mcap/mcap_writer.hpp"
#include "estimator/lidar/scan_assembler.hpp"
#include "estimator/types/pose.hpp"

namespace slamd {

enum class RecordedWire : std::uint8_t { kLidar, kImu, kGnss, kWheel };

/// How the recorder reads what it records, for the channels of values.
struct RecordedDrivers {
  LidarModel lidar_model = LidarModel::kVlp16;
  std::uint16_t lidar_port = 2368;
  std::uint16_t lidar_side_port = 8308;
  LidarDecoderConfig lidar;
  ImuFrameParser::Config imu_frames = ImuFrameParser::Config::defaults();
  NmeaParser::Config nmea = NmeaParser::Config::defaults();
  ScanAssemblerConfig scans;
  VehicleGeometry vehicle;
};

class McapRecording {
 public:
  /// Fails when the file is there already or cannot be made.
  /// config_yaml  the configuration in force: an attachment
  /// host_to_utc  added to host times wherever the file has times, and written down in it
  [[nodiscard]] static Result<std::unique_ptr<McapRecording>> open(const std::string& path, const std::string& config_yaml,
                                                                   const RecordedDrivers& drivers, Duration host_to_utc);

  void take(RecordedWire wire, const UdpPacket& read);
  void take(const LimitedScan& scan);
  void take(const PoseSample& pose);
  /// Where the sensors sit, again: a viewer that comes late has it.
  void repeat_transforms(HostTime now);

  /// As McapWriter's.
  Result<void> flush() { return file_.flush(); }
  Result<void> finish() { return file_.finish(); }
  std::uint64_t bytes() const { return file_.bytes(); }
  std::uint64_t messages() const { return file_.messages(); }

 private:
  struct Channels {
    std::uint16_t raw_lidar, raw_imu, raw_gnss, raw_wheel, scan_share, points, imu, fix, odometry, tf, tf_static;
  };

  McapRecording(McapWriter file, const RecordedDrivers& drivers, Duration host_to_utc);
  void add_channels();
  std::int64_t utc_ns(HostTime time) const { return to_ns(time + host_to_utc_); }
  void write(std::uint16_t channel, HostTime time, const Bytes& message);
  void take_points(const UdpPacket& read);
  void write_scan();

  McapWriter file_;
  Duration host_to_utc_;
  Channels channels_{};
  VehicleGeometry vehicle_;
  std::uint16_t lidar_port_;
  std::uint16_t lidar_side_port_;
  std::optional<SpinningLidar> lidar_;  // none: an RPLIDAR, which has no points in space
  ImuFrameParser imu_;
  NmeaParser gnss_;
  ScanAssembler assembler_;
  Scan scan_;  // the newest whole one
};

}  // namespace slamd
