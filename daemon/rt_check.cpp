#include "daemon/rt_check.hpp"

#include <algorithm>
#include <ostream>

#include "daemon/run.hpp"

namespace slamd {

doctor::Wanted wanted_of(const Config& config) {
  const RealTimeConfig& r = config.real_time;
  doctor::Wanted wanted;
  if (!config.lidar.source_address.empty()) wanted.lidar_address = config.lidar.source_address;
  wanted.receive_buffer_bytes = config.lidar.receive_buffer_bytes;
  wanted.priority = std::max({r.imu_priority, r.lidar_priority, r.gnss_priority, r.estimator_priority});
  wanted.estimator_cpu = r.estimator_cpu;
  return wanted;
}

int check_real_time(const Config& config, std::ostream& out) {
  const doctor::Findings findings = doctor::check_machine(doctor::HostFiles{}, wanted_of(config));
  out << doctor::text(findings);
  return doctor::all_right(findings) ? kExitDone : kExitFailure;
}

}  // namespace slamd
