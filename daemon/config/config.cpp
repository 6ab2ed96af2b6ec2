#include "daemon/config/config.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace slamd {
namespace {

void append(ConfigFaults& faults, ConfigFaults more) {
  for (std::string& fault : more) faults.push_back(std::move(fault));
}

/// What only two keys together can get wrong.
ConfigFaults contradictions(const std::string& name, const Config& c) {
  ConfigFaults faults;
  const auto demand = [&](bool holds, const char* key, const char* reason) {
    if (!holds) faults.push_back(name + ":0: " + key + ": " + reason);
  };
  demand(c.mode == "full" || c.mode == "planar", "mode", "must be full or planar");
  demand(c.planar.odometry.scan.band_low_m < c.planar.odometry.scan.band_high_m, "planar.band_low_m",
         "must be below planar.band_high_m");
  demand(c.lidar_decoder.min_range_m < c.lidar_decoder.max_range_m, "lidar.min_range_m", "must be below lidar.max_range_m");
  demand(lidar_model(c.lidar.model).has_value(), "lidar.model", "must be vlp16, airy or rplidar_a2");
  demand(c.lidar.model != "rplidar_a2" || c.mode == "planar", "mode", "must be planar: an RPLIDAR measures in one plane");
  demand(c.lidar.port != c.lidar.position_port, "lidar.position_port", "must differ from lidar.port");
  demand(c.nmea.noise.sigma_min_m <= c.nmea.noise.sigma_max_m, "gnss.sigma_min_m", "must not exceed gnss.sigma_max_m");
  const ImuSourceConfig& imu = c.imu.source;
  demand(is_imu_source(imu.kind), "imu.source", "must be serial or usb");
  demand(imu.kind != "serial" || imu.serial.path != c.gnss.serial.path || imu.serial.path.empty(), "gnss.device",
         "must differ from imu.device");
  const SegmenterConfig& segments = c.odometry.scans.assembler.segmenter;
  demand(segments.min_range_m < segments.max_range_m, "odometry.scan.min_range_m",
         "must be below odometry.scan.max_range_m");
  demand(c.odometry.status.usable_sigma_m <= c.odometry.status.lost_sigma_m, "odometry.usable_sigma_m",
         "must not exceed odometry.lost_sigma_m");
  return faults;
}

}  // namespace

Loaded<Config> load_config(const std::string& path, const std::vector<std::string>& overrides) {
  Loaded<Config> loaded;
  const std::vector<Field> fields = config_fields(loaded.value);
  if (!path.empty()) append(loaded.faults, read_yaml_file(path, fields));
  for (const std::string& assignment : overrides) append(loaded.faults, read_override(assignment, fields));
  if (loaded.faults.empty()) loaded.faults = contradictions(path.empty() ? "(configuration)" : path, loaded.value);
  loaded.value.back_end.loops.local_map_reach_m = loaded.value.odometry.fusion.registration.map.max_distance_m;
  return loaded;
}

ConfigChanges changes(const Config& running, const Config& wanted) {
  Config before = running;
  Config after = wanted;
  const std::vector<Field> old_fields = config_fields(before);
  const std::vector<Field> new_fields = config_fields(after);
  ConfigChanges found;
  for (std::size_t i = 0; i < old_fields.size(); ++i) {
    if (value_text(old_fields[i]) == value_text(new_fields[i])) continue;
    (old_fields[i].live ? found.live : found.fixed).push_back(old_fields[i].key);
  }
  return found;
}

Loaded<DriveVehicle> load_drive_vehicle(const std::string& path) {
  Loaded<DriveVehicle> loaded{{}, {}};
  loaded.faults = read_yaml_file(path, drive_vehicle_fields(loaded.value));
  const std::string& model = loaded.value.lidar_model;
  if (model != "laser_scan" && !lidar_model(model))
    loaded.faults.push_back(path + ":0: lidar_model: must be vlp16, airy, rplidar_a2 or laser_scan");
  return loaded;
}

std::string print_config(const Config& config) {
  Config copy = config;
  return "# Configuration of slamd: every key with its default. Unknown keys are errors; keys left out keep the "
         "default.\n"
         "# Check a file with `slamd --config FILE --check`; this file is the output of `slamd --print-config`.\n"
         "# Keys marked [reload] are taken over by a running slamd on SIGHUP (systemctl reload slamd).\n\n" +
         print_yaml(config_fields(copy));
}

}  // namespace slamd
