#pragma once
// Reads CLOCK_MONOTONIC for ages and periods. Samples carry their own times.

#include <ctime>

#include "estimator/types/time.hpp"

namespace slamd {

inline HostTime host_now() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return HostTime{std::chrono::seconds{now.tv_sec} + std::chrono::nanoseconds{now.tv_nsec}};
}

/// UTC less CLOCK_MONOTONIC: changes when either is set or begins anew.
inline Duration host_to_utc() {
  timespec utc{};
  ::clock_gettime(CLOCK_REALTIME, &utc);
  return std::chrono::seconds{utc.tv_sec} + std::chrono::nanoseconds{utc.tv_nsec} - host_now().time_since_epoch();
}

}  // namespace slamd
