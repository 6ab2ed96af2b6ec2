#pragma once
// Each sensor thread's report judged at one instant, in the health board's words: healthy, refused, silent, absent,
// no_fix. No I/O, no clock.

#include "daemon/health/health_board.hpp"
#include "daemon/threads/gnss_thread.hpp"
#include "daemon/threads/imu_thread.hpp"
#include "daemon/threads/lidar_thread.hpp"

namespace slamd {

/// The device's name is the caller's to fill in.
SourceHealth source_health(const LidarReport& report, HostTime now);
SourceHealth source_health(const ImuReport& report, HostTime now);
SourceHealth source_health(const GnssReport& report, HostTime now);

}  // namespace slamd
