#pragma once
// Decides when the service manager's watchdog is fed: only after every part of the daemon has moved on. It measures
// progress, not time spent, and restarts nothing itself.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "estimator/types/time.hpp"

namespace slamd {

class Watchdog {
 public:
  using Progress = std::function<std::uint64_t()>;  // a count that grows while the part works

  /// period  within which it must be fed; it is fed four times as often, as far as there is progress
  Watchdog(Duration period, HostTime now) : period_{period}, fed_at_{now} {}

  /// Before the first look().
  void watch(std::string part, Progress progress);

  /// Call it several times a quarter of the period. True when it is to be fed: every part has moved on since it was last
  /// told so, and that is a quarter of the period ago.
  bool look(HostTime now);

  /// The first part that stands still and has done so for more than half the period; "" when all move on.
  std::string stuck(HostTime now) const;

 private:
  struct Part {
    std::string name;
    Progress progress;
    std::uint64_t fed_with = 0;  // its count when the watchdog was last fed
    bool moved = false;          // since then
  };

  Duration period_;
  HostTime fed_at_;
  std::vector<Part> parts_;
};

}  // namespace slamd
