#pragma once
// Looks at the threads' reports a few times a second, judges the sensors and tells the log what has changed: the one place
// where real-time threads' counters become words. It reads atomics only and steers nothing.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/health/health_board.hpp"
#include "daemon/health/sensor_watch.hpp"
#include "daemon/server/protocol/pose_page.hpp"
#include "daemon/threads/change_log.hpp"

namespace slamd {

/// How a sensor stands: "state=faulty reason=silent, continuing:" and its counts.
Condition condition(const SourceHealth& health);
/// How the pose stands: "status=DEGRADED reasons=no_imu"; nothing published yet is the initial status.
Condition condition(const std::optional<PoseSample>& sample);
/// Whether a ring has lost anything since it had lost `dropped_before`.
Condition condition(const RingCounts& counts, std::uint64_t dropped_before);

/// What is kept within a byte budget. consequence: what the operator loses by it.
struct Budget {
  std::string name;
  std::string consequence;                  // "without the oldest keyframes"
  std::function<std::uint64_t()> let_go;    // how much; 0 as long as all has room
};

class Supervisor {
 public:
  using PoseProbe = std::function<std::optional<PoseSample>()>;

  Supervisor(Duration repeat_period, ChangeLog::Sink sink) : changes_{repeat_period, std::move(sink)} {}

  /// Registration, before the first look(). What the probes refer to must outlive the last one.
  /// The judge of a sensor, asked at every look(); lives as long as this.
  const SensorWatch& watch_sensor(const SensorPatience& patience, SensorWatch::Probe probe);
  void watch_source(std::string name, HealthBoard::SourceProbe probe);
  void watch_ring(std::string name, HealthBoard::RingProbe probe);
  void watch_budget(Budget budget) { budgets_.push_back(std::move(budget)); }
  void watch_pose(PoseProbe probe) { pose_ = std::move(probe); }

  /// One look at everything; not for real-time threads.
  void look(HostTime now);

  /// How all stands now, in one line for people: "TRACKING; lidar healthy, imu healthy, gnss absent".
  std::string summary() const;

  void set_repeat_period(Duration period) { changes_.set_repeat_period(period); }

 private:
  struct Ring {
    std::string name;
    HealthBoard::RingProbe probe;
    std::uint64_t dropped = 0;  // at the last look
  };

  ChangeLog changes_;
  PoseProbe pose_;
  std::vector<std::unique_ptr<SensorWatch>> sensors_;
  std::vector<std::pair<std::string, HealthBoard::SourceProbe>> sources_;
  std::vector<Ring> rings_;
  std::vector<Budget> budgets_;
};

}  // namespace slamd
