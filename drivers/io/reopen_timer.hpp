#pragma once
// When to look again for a device that is not there: at once, then with doubled waits. It opens nothing.

#include <algorithm>
#include <chrono>
#include <thread>

#include "drivers/io/byte_source.hpp"

namespace slamd {

class ReopenTimer {
 public:
  explicit ReopenTimer(const ReopenConfig& config) : config_{config} {}

  static HostTime now() { return HostTime{std::chrono::steady_clock::now().time_since_epoch()}; }

  bool is_due() const { return now() >= next_; }
  void succeeded() { backoff_ = Duration::zero(); }
  void failed() {
    backoff_ = std::clamp(2 * backoff_, config_.shortest, config_.longest);
    next_ = now() + backoff_;
  }
  /// The device went away while open.
  void lost() { next_ = now() + config_.shortest; }
  /// Sleeps until the next look is due, to `deadline` at most.
  void wait(HostTime deadline) const {
    const Duration left = std::min(deadline, next_) - now();
    if (left > Duration::zero()) std::this_thread::sleep_for(left);
  }

 private:
  ReopenConfig config_;
  HostTime next_{};
  Duration backoff_{};
};

}  // namespace slamd
