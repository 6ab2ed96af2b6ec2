#pragma once
// Roll, pitch and yaw to a rotation, in the one order that the simulator uses. No motion lives here.

#include <Eigen/Geometry>

namespace slamd::sim {

/// Radians, R = Rz(yaw) Ry(pitch) Rx(roll).
inline Eigen::Quaterniond from_roll_pitch_yaw(const Eigen::Vector3d& angles_rad) {
  return Eigen::AngleAxisd(angles_rad.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(angles_rad.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(angles_rad.x(), Eigen::Vector3d::UnitX());
}

}  // namespace slamd::sim
