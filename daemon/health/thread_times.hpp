#pragma once
// How much processor time each thread of this process has taken, as the kernel counts it. Reads /proc: not for real-time
// threads.

#include <cstdint>
#include <map>
#include <string>

namespace slamd {

struct ThreadTime {
  double cpu_s = 0.0;
  int priority = 0;  // SCHED_FIFO or SCHED_RR; 0: normal scheduling
};

/// By name; threads of one name are added up. Empty where /proc is not mounted.
std::map<std::string, ThreadTime> thread_times();

}  // namespace slamd
