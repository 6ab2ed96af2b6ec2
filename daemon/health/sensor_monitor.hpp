#pragma once
// Judges one sensor from what its thread and the estimator tell of it: a state and the reason. It steers nothing: what is
// used of a sensor the estimator decides by itself. No clock, no thread: the same evidence gives the same states.
// In the manner of PX4's DataValidator (error density, staged time-outs) and of its failure detector.

#include <cstdint>
#include <optional>

#include "estimator/types/time.hpp"

namespace slamd {

enum class SensorState : std::uint8_t {
  kAbsent,    // no device
  kStarting,  // there, and not yet good for long enough
  kHealthy,
  kDegraded,  // a defect, or one a moment ago
  kFaulty,    // fails for long or again and again; healthy only after a clean period
};

/// What is wrong, the worst first. Numbers are not part of the protocol, names are.
enum class SensorDefect : std::uint8_t {
  kNone,
  kNoDevice,
  kSilent,       // nothing comes
  kRefused,      // something comes, none of it is good
  kUnused,       // it is good in form, and the estimator does not believe it
  kNoFix,        // a receiver without a position
  kSlow,         // fewer items than it should send
  kDamaged,      // too large a part of it is refused
  kLossy,        // too large a part of it never arrived
  kDoubted,      // the estimator finds that it contradicts the rest
  kUnsureClock,  // its clock jumped or is not known yet
};

const char* name(SensorState state);
const char* name(SensorDefect defect);

/// Of one sensor at one instant. Counts are totals since the start.
struct SensorEvidence {
  enum class Use : std::uint8_t { kUsed, kDoubted, kRefused };

  bool present = false;                // its device is open; of a LiDAR: it was heard lately
  bool clock_sure = true;
  Use use = Use::kUsed;                // by the estimator
  std::optional<HostTime> heard{};      // newest bytes, good or not
  std::optional<HostTime> spoke{};      // newest good sentence of a receiver, with or without a fix
  std::optional<HostTime> good_at{};    // newest good item
  std::uint64_t good = 0;              // items
  std::uint64_t bad = 0;               // refused
  std::uint64_t lost = 0;              // never arrived
};

/// How long what is put up with.
struct SensorPatience {
  double late_s = 0.2;          // without a good item for so long: degraded
  double least_rate_hz = 0.0;   // fewer good items a second: degraded
  double most_bad_share = 0.05; // of the items of a second refused or lost: degraded
  double faulty_s = 1.0;        // silent, refused or unused for so long in sum: faulty; good times count a tenth against it
  double clean_s = 3.0;         // without any defect: faulty becomes healthy
  double proving_s = 1.0;       // likewise degraded and starting
};

struct SensorCondition {
  SensorState state = SensorState::kAbsent;
  SensorDefect defect = SensorDefect::kNoDevice;  // what keeps it from being healthy, or has made it faulty; kNone when it is
  HostTime since;                                 // of the state
  std::uint32_t times_faulty = 0;
};

/// One thread.
class SensorMonitor {
 public:
  explicit SensorMonitor(const SensorPatience& patience) : patience_{patience} {}

  /// Some ten times a second, `now` growing. Cost: a few comparisons, no allocation.
  const SensorCondition& look(const SensorEvidence& evidence, HostTime now);

 private:
  SensorDefect defect_of(const SensorEvidence& evidence, HostTime now) const;
  SensorDefect defect_of_counts(const SensorEvidence& evidence, double seconds) const;
  void count_window(const SensorEvidence& evidence, HostTime now);
  SensorState next_state(SensorDefect defect, HostTime now) const;

  SensorPatience patience_;
  SensorCondition condition_;
  SensorEvidence window_;                            // as it was when the running second began,
  std::optional<HostTime> window_begin_;
  SensorDefect last_window_ = SensorDefect::kNone;   // and what the second before it said
  std::optional<HostTime> looked_;
  HostTime clean_since_;
  double failing_s_ = 0.0;                           // seconds of hard defects, leaking
};

}  // namespace slamd
