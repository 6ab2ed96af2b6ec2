#pragma once
// Carries CLOCK_REALTIME receive stamps of the kernel over to CLOCK_MONOTONIC, and notices when the wall clock was set.
// Reads both clocks, sets none.

#include <cstdint>
#include <optional>

#include "estimator/types/time.hpp"

namespace slamd {

class ReceiveClock {
 public:
  /// Reads both clocks; once for each batch, after it was received. A few tens of nanoseconds.
  void sample();
  /// The same with given readings: realtime and monotonic nanoseconds of one instant.
  void sample(std::int64_t realtime_ns, HostTime now);

  /// When a datagram of the batch arrived. Nothing when the stamp does not lie in the recent past, or when the wall
  /// clock was set since the sample before this one: then its stamp may be of either side of the step.
  std::optional<HostTime> arrival(std::int64_t realtime_stamp_ns) const;

  HostTime now() const { return now_; }

 private:
  HostTime now_;
  std::int64_t realtime_now_ns_ = 0;
  std::optional<std::int64_t> offset_ns_;
  bool stepped_ = false;
};

}  // namespace slamd
