#pragma once
// A sensor's monitor with the probe that feeds it, and its newest word for other threads. It judges nothing itself.

#include <functional>
#include <utility>

#include "daemon/health/sensor_monitor.hpp"
#include "daemon/ring/latest_value.hpp"

namespace slamd {

class SensorWatch {
 public:
  using Probe = std::function<SensorEvidence(HostTime now)>;

  SensorWatch(const SensorPatience& patience, Probe probe) : monitor_{patience}, probe_{std::move(probe)} {}

  /// One thread, some ten times a second.
  void look(HostTime now) { told_.store(monitor_.look(probe_(now), now)); }

  /// Any thread. Absent before the first look().
  SensorCondition condition() const { return told_.load().value_or(SensorCondition{}); }

 private:
  SensorMonitor monitor_;
  Probe probe_;
  LatestValue<SensorCondition> told_;
};

}  // namespace slamd
