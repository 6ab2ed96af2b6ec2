#pragma once
// One IMU sample in SI units in the IMU's own frame, stamped in host time. No raw counts (drivers/imu converts them).

#include <Eigen/Core>

#include "estimator/types/time.hpp"

namespace slamd {

struct ImuSample {
  HostTime time;                                                // when it was measured
  HostTime arrival;                                             // when the host received it; orders the events
  Eigen::Vector3d gyro_rads = Eigen::Vector3d::Zero();          // imu frame, bias included
  Eigen::Vector3d accel_mps2 = Eigen::Vector3d::Zero();         // specific force, imu frame, bias included
  float temperature_c = 0.0F;
  bool clipped = false;                                         // any axis at the end of its range
  bool clock_unsure = false;                                    // the device's clock jumped and is not locked again
};

}  // namespace slamd
