#pragma once
// Scheduling of the calling thread and memory locking of the process. What the thread does is not known here.

#include <pthread.h>

#include "daemon/ring/unique_fd.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

/// How the daemon's threads are scheduled. Priorities are SCHED_FIFO 1..99; 0 leaves a thread under the normal
/// scheduler.
struct RealTimeConfig {
  bool lock_memory = true;
  int imu_priority = 60;  // also publishes the 200 Hz pose: above everything else of ours
  int lidar_priority = 50;
  int gnss_priority = 45;
  int estimator_priority = 40;  // the long computation: below those who must not miss a byte
  int driver_cpu = -1;          // -1: any
  int estimator_cpu = -1;
  int cpu_latency_us = 20;      // processors may take no longer to wake up; -1: as the system likes
};

struct ThreadSchedule {
  const char* name;  // at most 15 characters, shown by top and ps
  int priority = 0;
  int cpu = -1;
};

/// Names the calling thread, pins it, prefaults its stack and asks for its priority. Every step is tried even when one
/// fails; the first failure's reason comes back, and the thread goes on without what it was not given.
Result<void> enter_schedule(const ThreadSchedule& schedule);

/// Puts a thread before all that is not real-time, with the least priority of SCHED_FIFO; where that is not permitted it stays as it is.
void hurry(pthread_t thread);

/// Threads of the process that are started from now on get a stack of 2 MiB: a locked stack is resident as a whole.
/// Call before the first thread starts.
void keep_stacks_small();

/// Locks all present and future pages of the process into memory and keeps freed heap from going back to the kernel.
/// Call once before the real-time threads start. Fails without CAP_IPC_LOCK or enough RLIMIT_MEMLOCK.
Result<void> lock_memory();

/// Keeps processors from idling so deeply that waking up takes longer than most_us, as long as the descriptor is open
/// (/dev/cpu_dma_latency). Fails where the system has no such file or does not let us open it.
Result<UniqueFd> limit_cpu_latency(int most_us, const char* device = "/dev/cpu_dma_latency");

}  // namespace slamd
