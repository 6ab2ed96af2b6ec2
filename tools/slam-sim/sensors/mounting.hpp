#pragma once
// Where the sensors sit on the vehicle, and how far that is from what the vehicle's configuration says. No sensor lives here.

#include "estimator/types/pose.hpp"

namespace slamd::sim {

/// Mounting of the reference vehicle.
VehicleGeometry reference_vehicle();

/// A TurtleBot3 Burger: base between its wheels on the floor, the LDS-01 on top (ROBOTIS' robot description; no antenna).
VehicleGeometry turtlebot3_burger();

/// Of a LiDAR that sees one plane, on the reference vehicle: level, 0.6 m above the ground: higher up a car park or a street has little within 16 m.
Pose level_lidar_mount();

struct Mounting {
  VehicleGeometry told = reference_vehicle();                   // what vehicle.yaml says
  Eigen::Vector3d lidar_tilt_rad = Eigen::Vector3d::Zero();  // roll, pitch, yaw in the sensor's own frame: what nobody was told
  Eigen::Vector3d imu_tilt_rad = Eigen::Vector3d::Zero();

  /// Where the sensors are.
  VehicleGeometry actual() const;
};

}  // namespace slamd::sim
