#pragma once
// The whole configuration of slamd as one value, and its table of keys. The structs' defaults are the only defaults.

#include <string>
#include <vector>

#include "daemon/config/field.hpp"
#include "daemon/config/yaml_fields.hpp"
#include "daemon/health/health_config.hpp"
#include "daemon/server/server.hpp"
#include "daemon/store/map_store.hpp"
#include "daemon/threads/checkpoint_thread.hpp"
#include "daemon/threads/estimator_thread.hpp"
#include "daemon/threads/gnss_thread.hpp"
#include "daemon/threads/imu_thread.hpp"
#include "daemon/threads/lidar_thread.hpp"
#include "daemon/threads/log.hpp"
#include "daemon/threads/real_time.hpp"
#include "daemon/threads/recorder.hpp"
#include "daemon/threads/wheel_thread.hpp"
#include "drivers/gnss/nmea_parser.hpp"
#include "drivers/imu/imu_frame_parser.hpp"
#include "estimator/graph/back_end.hpp"
#include "estimator/grid/slam_2d.hpp"
#include "estimator/odometry/lidar_inertial_odometry.hpp"
#include "estimator/types/pose.hpp"

namespace slamd {

/// The vehicle of the documentation: VLP-16 1.86 m above base and pitched 11 degrees down.
VehicleGeometry reference_vehicle();

struct Config {
  std::string mode = "full";  // or "planar"
  VehicleGeometry vehicle = reference_vehicle();
  LidarThreadConfig lidar;
  LidarDecoderConfig lidar_decoder;
  ImuThreadConfig imu;
  ImuFrameParser::Config imu_frames = ImuFrameParser::Config::defaults();
  GnssThreadConfig gnss;
  NmeaParser::Config nmea = NmeaParser::Config::defaults();
  WheelThreadConfig wheel;
  OdometryConfig odometry;
  EstimatorThreadConfig estimator;
  BackEndConfig back_end;
  Slam2dConfig planar;
  MapStoreConfig map;
  CheckpointConfig checkpoint;
  FlightRecorderConfig flight_recorder;
  RecordingConfig recording;
  ServerConfig server;
  HealthConfig health;
  RealTimeConfig real_time;
  LogConfig log;
};

/// Every key of slamd.yaml, bound to the members of `config`, which must outlive the table.
std::vector<Field> config_fields(Config& config);

/// What a drive folder's vehicle.yaml says: where the sensors are, and how the LiDAR's rays begin (LidarDecoderConfig); the format is
/// older than that key, and drives without it have rays from one point.
struct DriveVehicle {
  VehicleGeometry geometry = reference_vehicle();
  bool lidar_vertical_offsets = false;
  std::string lidar_model = "vlp16";  // vlp16, airy, rplidar_a2 or laser_scan: which of the drive's files has the LiDAR
};
std::vector<Field> drive_vehicle_fields(DriveVehicle& vehicle);

/// What a file gave: `value` is meaningful only when `faults` is empty.
template <class T>
struct Loaded {
  T value;
  ConfigFaults faults;
};

/// Defaults, then the file (none when path is empty), then each "key=value". Checks also what only two keys together
/// can get wrong. Never throws on bad input.
Loaded<Config> load_config(const std::string& path, const std::vector<std::string>& overrides = {});

/// Keys whose values differ. A change of `live` keys alone can be taken over while slamd runs; `fixed` need a restart.
struct ConfigChanges {
  std::vector<std::string> live;
  std::vector<std::string> fixed;
};
ConfigChanges changes(const Config& running, const Config& wanted);

/// vehicle.yaml of a drive folder: T_base_lidar, T_base_imu (translation_m, rotation_quat_xyzw), p_base_antenna,
/// lidar_vertical_offsets, lidar_model. Keys that it does not have keep the value of a default DriveVehicle.
Loaded<DriveVehicle> load_drive_vehicle(const std::string& path);

/// The configuration as a slamd.yaml that documents every key; of a default Config this is config/slamd.yaml.
std::string print_config(const Config& config);

}  // namespace slamd
