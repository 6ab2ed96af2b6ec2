#pragma once
// What a recording holds, whatever its form: a stream for each sensor that is in it. drive.hpp merges them to events.

#include <cstdint>
#include <map>
#include <memory>

#include "drivers/gnss/nmea_parser.hpp"
#include "drivers/imu/imu_frame_parser.hpp"
#include "drivers/io/lidar_stats.hpp"
#include "drivers/io/sample_clock.hpp"
#include "drivers/lidar/lidar_model.hpp"
#include "drivers/robosense/airy_imu_parser.hpp"
#include "drivers/rplidar/rplidar_parser.hpp"
#include "estimator/types/gnss_fix.hpp"
#include "estimator/types/imu_sample.hpp"
#include "estimator/types/laser_scan.hpp"
#include "estimator/types/lidar_packet.hpp"
#include "estimator/types/wheel_odometry.hpp"
#include "tools/slam-replay/drive/stream.hpp"

namespace slamd::replay {

/// Which LiDAR it was, and to which ports it sent.
struct LidarSetup {
  LidarModel model = LidarModel::kVlp16;
  LidarPorts ports = ports_of(LidarModel::kVlp16);
  LidarDecoderConfig decoder;
};

/// How the drivers read what was recorded.
struct DriverConfigs {
  LidarSetup lidar;
  RplidarParser::Config rplidar;
  AiryImuParser::Config airy_imu = AiryImuParser::Config::defaults();
  SampleClock::Config imu_clock;                                           // of imu.csv
  ImuFrameParser::Config imu_frames = ImuFrameParser::Config::defaults();  // of an IMU's bytes
  NmeaParser::Config nmea = NmeaParser::Config::defaults();
};

/// Null: the sensor is not there.
struct Sensors {
  std::unique_ptr<Stream<LidarPacket>> lidar;
  std::unique_ptr<Stream<ImuSample>> imu;
  std::unique_ptr<Stream<GnssFix>> gnss;
  std::unique_ptr<Stream<WheelOdometry>> wheel;
  std::unique_ptr<Stream<LaserScan>> laser;
  std::map<HostTime, double> scan_shares;  // by end of a scan: of its points, where the live estimator had no time for more
  std::map<HostTime, HostTime> recorded_stamps;  // by an item's time: what the recording says, where it was out of order
};

}  // namespace slamd::replay
