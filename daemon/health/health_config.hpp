#pragma once
// What the daemon puts up with from each sensor before it says so, and whether faults may be injected. Plain values.

#include "daemon/health/sensor_monitor.hpp"

namespace slamd {

struct HealthConfig {
  SensorPatience lidar{.least_rate_hz = 600.0};  // a VLP-16 sends 754 packets a second
  SensorPatience imu{.least_rate_hz = 100.0};
  SensorPatience gnss{.late_s = 2.5, .most_bad_share = 0.3, .faulty_s = 10.0, .clean_s = 10.0, .proving_s = 3.0};
  bool allow_inject = false;  // failures may be played on purpose (daemon/inject)
};

}  // namespace slamd
