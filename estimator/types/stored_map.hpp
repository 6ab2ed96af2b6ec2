#pragma once
// What of a map outlives the process: its newest keyframes, where the vehicle was, and where the map lies on the earth. A
// value without behaviour; bytes and files are daemon/store's.

#include <array>
#include <cstdint>
#include <vector>

#include "estimator/types/pose.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

struct StoredKeyframe {
  HostTime time;
  Pose T_map_base;
  Matrix6d relative_covariance = Matrix6d::Zero();  // as Keyframe's; from the keyframe before it
  std::vector<std::uint8_t> cloud;                  // its points as estimator/graph/packed_cloud packs them
};

/// Map in local East-North-Up, and where that begins (WGS-84).
struct StoredEnu {
  double yaw_rad = 0.0;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  std::array<double, 16> covariance{};  // rows 0-2 translation (m), row 3 yaw (rad); row-major
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double ellipsoid_height_m = 0.0;
};

struct StoredMap {
  std::vector<StoredKeyframe> keyframes;  // in order of time
  Pose T_map_base;                        // where the vehicle was
  bool enu_valid = false;                 // false: enu says nothing
  StoredEnu enu;
};

}  // namespace slamd
