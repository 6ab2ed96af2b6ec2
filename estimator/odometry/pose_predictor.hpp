#pragma once
// The pose between scans: the newest posterior carried forward by every IMU sample. Runs on the IMU thread, knows no map.

#include "estimator/filter/imu_propagation.hpp"
#include "estimator/odometry/imu_buffer.hpp"
#include "estimator/types/nav_state.hpp"

namespace slamd {

class PosePredictor {
 public:
  PosePredictor(const VehicleGeometry& geometry, const ImuNoise& noise);

  /// A new posterior: buffered samples younger than it are applied anew. Status and reasons of `posterior` are kept.
  void correct(const FilterSnapshot& snapshot, const NavState& posterior);
  /// The pose at the sample's time; before the first posterior its status is kInitialising. Bounded work, no allocation.
  NavState add(const ImuSample& sample);
};

}  // namespace slamd
