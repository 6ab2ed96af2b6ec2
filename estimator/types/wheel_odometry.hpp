#pragma once
// Where the wheels say that the vehicle has gone since the counter was at zero: a pose in the wheels' own plane. Drifts without bound.

#include "estimator/types/time.hpp"

namespace slamd {

struct WheelOdometry {
  HostTime time;     // when it was measured
  HostTime arrival;  // when the host received it; orders the events
  double x_m = 0.0;  // base in the frame where the wheels began
  double y_m = 0.0;
  double yaw_rad = 0.0;  // continuous, not wrapped
};

}  // namespace slamd
