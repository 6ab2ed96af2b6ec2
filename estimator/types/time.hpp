#pragma once
// Time points of the three clock domains: distinct types, so that mixing them does not compile. No clock is read here.

#include <chrono>
#include <cmath>
#include <cstdint>

namespace slamd {

using Duration = std::chrono::nanoseconds;

/// CLOCK_MONOTONIC of the host: the only time used inside slamd.
struct HostClock {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<HostClock>;
  static constexpr bool is_steady = true;
};
/// A sensor's own counter, unwrapped; its origin and rate are its own (drivers/io/clock_sync maps it to host time).
struct DeviceClock {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<DeviceClock>;
  static constexpr bool is_steady = false;
};
/// UTC as sent by a GNSS receiver, nanoseconds since 1970-01-01.
struct GnssClock {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<GnssClock>;
  static constexpr bool is_steady = false;
};

using HostTime = HostClock::time_point;
using DeviceTime = DeviceClock::time_point;
using GnssTime = GnssClock::time_point;

constexpr double to_seconds(Duration d) { return static_cast<double>(d.count()) * 1e-9; }
inline Duration from_seconds(double s) { return Duration{std::llround(s * 1e9)}; }

/// Nanoseconds since the clock's origin, and back: for files and wires only.
template <class TimePoint>
constexpr std::int64_t to_ns(TimePoint t) { return t.time_since_epoch().count(); }
template <class TimePoint>
constexpr TimePoint from_ns(std::int64_t ns) { return TimePoint{Duration{ns}}; }

}  // namespace slamd
