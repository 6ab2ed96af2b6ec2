#pragma once
// A pause of the calling thread that takes no lock and allocates nothing. Not a timer: it may last longer.

#include <ctime>

#include "estimator/types/time.hpp"

namespace slamd {

inline void pause_for(Duration duration) {
  const timespec length{duration.count() / 1'000'000'000, duration.count() % 1'000'000'000};
  clock_nanosleep(CLOCK_MONOTONIC, 0, &length, nullptr);
}

}  // namespace slamd
