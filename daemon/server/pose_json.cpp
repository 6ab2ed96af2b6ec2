#include "daemon/server/pose_json.hpp"

#include "estimator/types/nav_state.hpp"

namespace slamd {

using nlohmann::json;

json reason_names(std::uint32_t reasons) {
  json names = json::array();
  for (std::uint32_t bit = 1; bit != 0 && bit <= reasons; bit <<= 1U) {
    if ((reasons & bit) != 0) names.push_back(name(static_cast<StatusReason>(bit)));
  }
  return names;
}

json pose_json(const PoseSample& sample) {
  const auto pose = [](const auto& position_m, const auto& rotation_xyzw) {
    return json{{"translation_m", position_m}, {"rotation_quat_xyzw", rotation_xyzw}};
  };
  json object = {{"time_ns", sample.host_time_ns},
                 {"utc_offset_ns", nullptr},
                 {"sequence", sample.sequence},
                 {"status", name(static_cast<TrackingStatus>(sample.status))},
                 {"reasons", reason_names(sample.reasons)},
                 {"T_map_base", pose(sample.map_position_m, sample.map_rotation_xyzw)},
                 {"T_odom_base", pose(sample.odom_position_m, sample.odom_rotation_xyzw)},
                 {"velocity_mps", sample.velocity_mps},
                 {"angular_velocity_rads", sample.angular_velocity_rads},
                 {"covariance", sample.covariance},
                 {"degenerate_direction", sample.degenerate_direction},
                 {"lidar_test_ratio", sample.lidar_test_ratio},
                 {"map_corrections", sample.map_corrections}};
  if (sample.utc_offset_ns != kUtcOffsetUnknown) object["utc_offset_ns"] = sample.utc_offset_ns;
  return object;
}

}  // namespace slamd
