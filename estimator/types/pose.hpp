#pragma once
// A rigid transform T_a_b: p_a = T_a_b * p_b. Plain value; the Lie group operations are in estimator/math/lie.hpp.

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace slamd {

struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // R_a_b, unit
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();         // origin of b in a, metres

  Eigen::Vector3d operator*(const Eigen::Vector3d& p_b) const { return rotation * p_b + translation; }
  Pose operator*(const Pose& T_b_c) const {
    return {(rotation * T_b_c.rotation).normalized(), rotation * T_b_c.translation + translation};
  }
  Pose inverse() const {
    const Eigen::Quaterniond R_b_a = rotation.conjugate();
    return {R_b_a, -(R_b_a * translation)};
  }
};

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Where the sensors sit on the vehicle. base: footprint on the ground, x forward, y left, z up.
struct VehicleGeometry {
  Pose T_base_lidar;
  Pose T_base_imu;
  Eigen::Vector3d p_base_antenna = Eigen::Vector3d::Zero();
};

}  // namespace slamd
