#pragma once
// Which failure is played on which sensor, and until when: turned by the server, read by the driver threads. It breaks
// nothing itself (wire_fault, value_fault do).

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string_view>

#include "estimator/types/time.hpp"

namespace slamd {

/// In the manner of PX4's failure injection.
enum class FaultVerb : std::uint8_t {
  kNone,
  kOff,           // nothing comes
  kStuck,         // the newest values again and again, with stamps that go on
  kGarbage,       // an eighth of the bytes is noise
  kWrong,         // values that a mounting or a sensor gone wrong would give
  kSlow,          // one item of four
  kDelayed,       // the bytes come late, and all that wait at once when it ends
  kIntermittent,  // off half of the time
};
inline constexpr std::array kFaultVerbs{FaultVerb::kNone,  FaultVerb::kOff,  FaultVerb::kStuck,   FaultVerb::kGarbage,
                                        FaultVerb::kWrong, FaultVerb::kSlow, FaultVerb::kDelayed, FaultVerb::kIntermittent};

/// "none", "off", ...
const char* name(FaultVerb verb);
std::optional<FaultVerb> fault_verb(std::string_view name);

/// One writer, any readers, wait-free; a reader that finds it off pays one relaxed load.
class FaultSwitch {
 public:
  /// From now on, and no longer than until then.
  void set(FaultVerb verb, HostTime until) {
    const auto time = static_cast<std::uint64_t>(to_ns(until)) & ~kVerbBits;
    word_.store(verb == FaultVerb::kNone ? 0 : time | static_cast<std::uint64_t>(verb), std::memory_order_relaxed);
  }

  /// What is played at `now`.
  FaultVerb verb(HostTime now) const {
    const std::uint64_t word = word_.load(std::memory_order_relaxed);
    return word != 0 && now < end_of(word) ? static_cast<FaultVerb>(word & kVerbBits) : FaultVerb::kNone;
  }

  double seconds_left(HostTime now) const {
    const std::uint64_t word = word_.load(std::memory_order_relaxed);
    return word == 0 ? 0.0 : to_seconds(end_of(word) - now);
  }

 private:
  static constexpr std::uint64_t kVerbBits = 7;  // the time is kept to 8 ns
  static HostTime end_of(std::uint64_t word) { return from_ns<HostTime>(static_cast<std::int64_t>(word & ~kVerbBits)); }

  std::atomic<std::uint64_t> word_{0};
};

struct FaultBoard {
  FaultSwitch lidar, imu, gnss;
};

}  // namespace slamd
