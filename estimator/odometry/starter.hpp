#pragma once
// The first moments: watches the IMU until it is known how the vehicle stands, waits a grace time for an IMU that is late,
// and gives the filter's first state. Whether a moving start then finds its velocity is odometry/velocity_search.

#include <optional>

#include "estimator/filter/initialisation.hpp"
#include "estimator/types/scan.hpp"

namespace slamd {

struct StarterConfig {
  InitialisationConfig initialisation;
  double imu_grace_s = 1.0;   // the LiDAR waits so long for the first IMU sample, then starts without
};

class Starter {
 public:
  Starter(const VehicleGeometry& geometry, const StarterConfig& config);

  /// Samples of a working IMU in order of time; ignored once state() was given.
  void add(const ImuSample& sample);
  /// What the IMU has said so far was wrong.
  void forget_samples() { initialisation_.clear(); }
  /// Starts anew.
  void clear();

  bool is_done() const { return done_; }
  /// The first state at the scan's begin, or nothing as long as waiting promises a better one.
  std::optional<InitialState> state(const Scan& scan, bool imu_is_alive, bool with_extrinsic);

 private:
  Pose T_base_imu_;
  Pose T_imu_lidar_;
  StarterConfig config_;
  Initialisation initialisation_;
  std::optional<HostTime> first_scan_;
  bool done_ = false;
};

}  // namespace slamd
