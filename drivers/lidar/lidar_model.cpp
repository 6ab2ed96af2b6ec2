#include "drivers/lidar/lidar_model.hpp"

#include <array>

namespace slamd {

const char* name(LidarModel model) {
  switch (model) {
    case LidarModel::kVlp16: return "vlp16";
    case LidarModel::kAiry: return "airy";
    case LidarModel::kRplidarA2: break;
  }
  return "rplidar_a2";
}

std::optional<LidarModel> lidar_model(std::string_view wanted) {
  for (const LidarModel model : {LidarModel::kVlp16, LidarModel::kAiry, LidarModel::kRplidarA2}) {
    if (wanted == name(model)) return model;
  }
  return std::nullopt;
}

LidarPorts ports_of(LidarModel model) {
  switch (model) {
    case LidarModel::kVlp16: return {2368, 8308, 0};
    case LidarModel::kAiry: return {6699, 7788, 6688};
    case LidarModel::kRplidarA2: break;
  }
  return {0, 0, 0};
}

}  // namespace slamd
