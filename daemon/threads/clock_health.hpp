#pragma once
// How well a device's clock is known, in the words of the health board. One function.

#include "daemon/health/health_board.hpp"
#include "drivers/io/clock_sync.hpp"

namespace slamd {

inline ClockHealth clock_health(const ClockSync& clock) {
  return {.locked = clock.locked(),
          .skew_ppm = clock.skew_ppm(),
          .skew_sigma_ppm = clock.skew_sigma_ppm(),
          .sigma_s = to_seconds(clock.sigma()),
          .jumps = clock.jumps()};
}

}  // namespace slamd
