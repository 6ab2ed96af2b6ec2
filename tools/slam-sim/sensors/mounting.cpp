#include "tools/slam-sim/sensors/mounting.hpp"

#include "tools/slam-sim/motion/euler.hpp"

namespace slamd::sim {

VehicleGeometry reference_vehicle() {
  VehicleGeometry vehicle;
  vehicle.T_base_lidar = {Eigen::Quaterniond(0.995396198367, 0.0, 0.095845752520, 0.0).normalized(),
                          {0.45, 0.02, 1.86}};
  vehicle.T_base_imu = {Eigen::Quaterniond(0.699404695268, 0.019093388559, 0.003285447570, 0.714463239491).normalized(),
                        {0.12, -0.08, 1.52}};
  vehicle.p_base_antenna = {-0.60, 0.35, 1.74};
  return vehicle;
}

VehicleGeometry turtlebot3_burger() {
  VehicleGeometry vehicle;
  vehicle.T_base_lidar.translation = {-0.032, 0.0, 0.182};
  vehicle.T_base_imu.translation = {-0.032, 0.0, 0.078};
  return vehicle;
}

Pose level_lidar_mount() { return {Eigen::Quaterniond::Identity(), {0.45, 0.02, 0.6}}; }

VehicleGeometry Mounting::actual() const {
  VehicleGeometry out = told;
  if (!lidar_tilt_rad.isZero()) out.T_base_lidar.rotation = told.T_base_lidar.rotation * from_roll_pitch_yaw(lidar_tilt_rad);
  if (!imu_tilt_rad.isZero()) out.T_base_imu.rotation = told.T_base_imu.rotation * from_roll_pitch_yaw(imu_tilt_rad);
  return out;
}

}  // namespace slamd::sim
