#pragma once
// Decides the order in which the sensors' events reach the estimator, so that a live run and a replay of its recording
// give it the same sequence. Holds no events: it is told when the oldest of each source arrived.

#include <cstdint>
#include <optional>

#include "estimator/types/time.hpp"

namespace slamd {

struct EventMergeConfig {
  /// An event waits so long for an earlier one of another, slower thread. Longer than a driver thread's worst delay.
  Duration hold_back = std::chrono::milliseconds{5};
  /// After so long without events the estimator is told that time has passed, and then again each time.
  Duration silence = std::chrono::milliseconds{50};
};

/// Arrival of the oldest waiting event of each source; nothing where none waits. Each source is in order of arrival.
struct EventHeads {
  std::optional<HostTime> imu;
  std::optional<HostTime> lidar;
  std::optional<HostTime> gnss;
  std::optional<HostTime> wheel{};
  std::optional<HostTime> laser{};
};

struct NextEvent {
  enum class Kind { kNone, kImu, kLidar, kGnss, kWheel, kLaser, kSilence };
  Kind kind = Kind::kNone;
  HostTime time;  // arrival of the event, or the instant up to which there was silence
};

/// A pure function of its inputs; one thread. Equal arrivals go imu, lidar, gnss, wheel, laser.
class EventMerge {
 public:
  explicit EventMerge(const EventMergeConfig& config) : config_{config} {}

  /// What comes next at host time `now`. The caller consumes it before the next call. A replay passes heads that are
  /// never empty before their end and the newest arrival plus hold_back as `now`. An hour after the last event no more silence
  /// is told: a drive whose stamps jump by years has an end all the same.
  NextEvent next(const EventHeads& heads, HostTime now);

  /// Events that came after a later one had been handed out: their thread was slower than hold_back. With none of them the
  /// order is a function of the arrival stamps alone, and a replay has the same.
  std::uint64_t late() const { return late_; }

 private:
  EventMergeConfig config_;
  HostTime heard_;                // of the newest event that was no silence
  std::optional<HostTime> last_;  // of the newest event handed out,
  NextEvent::Kind last_kind_ = NextEvent::Kind::kNone;  // and what it was
  std::uint64_t late_ = 0;
};

}  // namespace slamd
