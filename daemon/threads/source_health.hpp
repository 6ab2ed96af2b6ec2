#pragma once
// Each sensor thread's report in the words of the health board (counts) and of its monitor (evidence). No I/O, no clock.

#include <optional>

#include "daemon/health/health_board.hpp"
#include "daemon/health/sensor_monitor.hpp"
#include "daemon/server/protocol/pose_page.hpp"
#include "daemon/threads/back_end_state.hpp"
#include "daemon/threads/gnss_thread.hpp"
#include "daemon/threads/imu_thread.hpp"
#include "daemon/threads/lidar_thread.hpp"
#include "daemon/threads/wheel_thread.hpp"

namespace slamd {

/// The counts; device and state are the caller's to fill in.
SourceHealth source_health(const LidarReport& report);
SourceHealth source_health(const ImuReport& report);
SourceHealth source_health(const GnssReport& report);
SourceHealth source_health(const WheelReport& report);

/// What the monitor judges. pose  the newest one; gnss  the back end's word on the receiver, none when it uses none.
SensorEvidence evidence(const LidarReport& report, const std::optional<PoseSample>& pose, HostTime now);
SensorEvidence evidence(const ImuReport& report, const std::optional<PoseSample>& pose);
SensorEvidence evidence(const GnssReport& report, const std::optional<GnssState>& gnss);

/// The counts with the monitor's judgement.
SourceHealth judged(SourceHealth health, const SensorCondition& condition);

}  // namespace slamd
