#pragma once
// Reads CLOCK_MONOTONIC for the server's ages and periods. Samples carry their own times.

#include <ctime>

#include "estimator/types/time.hpp"

namespace slamd {

inline HostTime host_now() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return HostTime{std::chrono::seconds{now.tv_sec} + std::chrono::nanoseconds{now.tv_nsec}};
}

}  // namespace slamd
