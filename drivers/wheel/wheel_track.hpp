#pragma once
// Wheel readings in order to odometry in host time: unwraps the counter, doubts what cannot be, and goes on across a restart
// of the device. It reads no bytes (wheel_parser.hpp) and estimates nothing.

#include <cstdint>
#include <optional>

#include "drivers/io/clock_sync.hpp"
#include "drivers/io/driver_stats.hpp"
#include "drivers/wheel/wheel_reading.hpp"
#include "estimator/types/wheel_odometry.hpp"

namespace slamd {

/// Why a reading gave no odometry.
enum class WheelRejection : std::uint8_t {
  kImpossible,  // a number that is not finite or beyond any vehicle
  kRepeated,    // the counter did not advance
  kDoubtful,    // counter or pose far from the expected, not confirmed by the reading before
  kCount
};
/// Short English name for reports ("doubtful").
const char* name(WheelRejection cause);

struct WheelTrackStats {
  std::uint64_t accepted = 0;
  std::uint64_t restarts = 0;  // counter or pose began anew; the motion across it is unknown and taken as none
  CauseCounters<WheelRejection> rejections;
};

struct WheelTrackConfig {
  ClockSync::Config clock;                  // wheel.latency_s is clock.min_latency
  Duration stamp_tolerance{1'000'000'000};  // the counter's advance against arrival's
  double most_speed_mps = 60.0;             // between two readings, plus
  double slack_m = 0.2;                     // this
  double most_rate_rads = 10.0;             // likewise of yaw
  double slack_rad = 0.2;
  static WheelTrackConfig defaults();
};

/// One thread uses an instance; no allocation.
class WheelTrack {
 public:
  explicit WheelTrack(const WheelTrackConfig& config = WheelTrackConfig::defaults()) : config_{config}, clock_{config.clock} {}

  /// The next reading in order of arrival. Nothing when it is refused: once when it does not follow the one before, and
  /// believed when the next goes on from it. Then, and after a restart of the device, x, y and yaw go on from where they
  /// were; yaw is continuous also where the device wraps it.
  std::optional<WheelOdometry> add(const WheelReading& reading, HostTime arrival);

  const WheelTrackStats& stats() const { return stats_; }
  const ClockSync& clock() const { return clock_; }

 private:
  struct Placed {
    WheelReading reading;
    DeviceTime device;
    HostTime arrival;
  };

  bool follows(const Placed& earlier, const Placed& later) const;
  std::optional<WheelOdometry> refuse(WheelRejection cause);
  void carry_on(const WheelReading& from, const WheelReading& to);

  WheelTrackConfig config_;
  CounterUnwrapper counter_{kWheelCounterPeriod};
  ClockSync clock_;
  std::optional<Placed> last_;
  std::optional<Placed> doubtful_;  // a reading that did not follow last_; the next one decides
  WheelOdometry out_;
  double frame_yaw_rad_ = 0.0;  // of the device's present frame in the one that is given out; a restart changes it
  WheelTrackStats stats_;
};

}  // namespace slamd
