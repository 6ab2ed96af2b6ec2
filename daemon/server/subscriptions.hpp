#pragma once
// What one client is subscribed to, and when it is due. Sends nothing.

#include <algorithm>
#include <optional>

#include "estimator/types/time.hpp"

namespace slamd {

/// Lets through, of a stream of times, about one a period; shut until opened.
class RateGate {
 public:
  void open(Duration period) {
    period_ = period;
    due_.reset();
  }
  void shut() { period_.reset(); }
  bool is_open() const { return period_.has_value(); }

  /// Is something of this time due? If so the next is due a period later; the average rate stays the asked one also
  /// when the stream's own period does not divide it.
  bool pass(HostTime time) {
    if (!period_) return false;
    const bool lost_track = !due_ || time > *due_ + *period_ || time + 2 * *period_ < *due_;
    if (lost_track) due_ = time;
    if (time + *period_ / 8 < *due_) return false;
    due_ = *due_ + *period_;
    return true;
  }

  /// The next time passes, whatever it is.
  void hurry() { due_.reset(); }

 private:
  std::optional<Duration> period_;
  std::optional<HostTime> due_;
};

struct Subscriptions {
  RateGate pose;    // by the samples' own times
  RateGate status;  // by the server's clock
  RateGate grid;    // likewise, of those that are new
  std::uint64_t told_grid = 0;  // GridStore's count of the one that was told last

  bool any() const { return pose.is_open() || status.is_open() || grid.is_open(); }
};

}  // namespace slamd
