#pragma once
// How long a sensor's stamps are doubted after one that cannot be: the reason kClockUnsure. Corrects no stamp.

#include <algorithm>
#include <optional>

#include "estimator/types/time.hpp"

namespace slamd {

/// What was received was measured before: a stamp later than the arrival by more than this is wrong. Less is the
/// uncertainty of drivers/io/clock_sync.
inline constexpr Duration kMostAhead = std::chrono::milliseconds{100};

class ClockDoubt {
 public:
  void raise(HostTime at) { newest_ = newest_ ? std::max(*newest_, at) : at; }
  bool holds(HostTime at) const { return newest_ && at - *newest_ < kLasts; }

 private:
  static constexpr Duration kLasts = std::chrono::seconds{1};
  std::optional<HostTime> newest_;
};

}  // namespace slamd
