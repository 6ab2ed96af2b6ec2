#pragma once
// Which time the messages of one topic have: that of their headers, moved to the recording's own clock where the two are of different
// clocks, or that of their recording where headers have none.

#include <algorithm>
#include <optional>

#include "drivers/io/host_ns.hpp"
#include "estimator/types/time.hpp"

namespace slamd::replay {

class TopicClock {
 public:
  TopicClock() = default;
  /// stamped  headers have times; shift  is added to them
  TopicClock(bool stamped, Duration shift) : stamped_{stamped}, shift_{shift} {}

  /// Of a message with that stamp which was recorded then.
  HostTime time(std::int64_t stamp_ns, HostTime recorded) const {
    const std::int64_t shifted_ns = stamp_ns + shift_.count();
    if (!stamped_ || !is_host_ns(stamp_ns) || !is_host_ns(shifted_ns)) return recorded;
    return from_ns<HostTime>(shifted_ns);
  }

 private:
  bool stamped_ = true;
  Duration shift_{};
};

/// Arrivals in the order in which they are asked for: never before the one before.
class ArrivalOrder {
 public:
  HostTime next(HostTime arrival) { return newest_ = std::max(newest_, arrival); }

 private:
  HostTime newest_;
};

}  // namespace slamd::replay
