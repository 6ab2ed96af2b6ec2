#pragma once
// The LiDARs that slamd knows, by the names of lidar.model and of a drive's lidar_model. No driver lives here.

#include <cstdint>
#include <optional>
#include <string_view>

namespace slamd {

enum class LidarModel : std::uint8_t {
  kVlp16,      // spinning, UDP
  kAiry,       // likewise
  kRplidarA2,  // in one plane, serial
};

/// "vlp16", "airy", "rplidar_a2".
const char* name(LidarModel model);
/// Nothing for another name.
std::optional<LidarModel> lidar_model(std::string_view name);

/// UDP ports of a sensor as delivered; 0 = it has none.
struct LidarPorts {
  std::uint16_t points;  // data packets
  std::uint16_t side;    // VLP-16: position packets; Airy: device packets
  std::uint16_t imu;     // of the IMU that is built in
};
LidarPorts ports_of(LidarModel model);

}  // namespace slamd
