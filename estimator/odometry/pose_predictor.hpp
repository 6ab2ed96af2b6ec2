#pragma once
// The pose between scans: the newest posterior carried forward by every IMU sample. Runs on the IMU thread, knows no map.

#include "estimator/odometry/dead_reckoning.hpp"
#include "estimator/odometry/imu_intake.hpp"
#include "estimator/types/nav_state.hpp"

namespace slamd {

class PosePredictor {
 public:
  PosePredictor(const VehicleGeometry& geometry, const DeadReckoningConfig& dead_reckoning, const ImuIntakeConfig& imu);

  /// A new posterior: samples younger than it are applied anew at the next add(). Status of `posterior` is kept.
  void correct(const FilterSnapshot& snapshot, const NavState& posterior);
  /// The pose at the sample's time; before the first posterior its status is kInitialising. A sample that ImuIntake does not
  /// take moves nothing but time, one stamped in the future not even that. Bounded work, no allocation.
  NavState add(const ImuSample& sample);
  /// The pose at `time` when no sample comes: the constant-velocity model carries on.
  NavState coast_to(HostTime time);

 private:
  NavState state() const;

  Pose T_base_imu_;
  DeadReckoning dead_reckoning_;
  ImuIntake imu_;
  FilterSnapshot filter_;
  NavState posterior_;
  bool has_posterior_ = false;
};

}  // namespace slamd
