#include "daemon/threads/real_time.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>

namespace slamd {
namespace {

constexpr std::size_t kThreadStackBytes = 2 * 1024 * 1024;
constexpr std::size_t kStackPrefaultBytes = 512 * 1024;

/// Touches the pages that deep calls will use, so that none of them faults later.
void prefault_stack() {
  [[maybe_unused]] volatile unsigned char page_in[kStackPrefaultBytes];
  for (std::size_t i = 0; i < kStackPrefaultBytes; i += 4096) page_in[i] = 1;
}

}  // namespace

Result<void> enter_schedule(const ThreadSchedule& schedule) {
  Result<void> outcome;
  pthread_setname_np(pthread_self(), schedule.name);
  prefault_stack();
  if (schedule.cpu >= 0) {
    cpu_set_t cpus;
    CPU_ZERO(&cpus);
    CPU_SET(static_cast<unsigned>(schedule.cpu), &cpus);
    if (pthread_setaffinity_np(pthread_self(), sizeof cpus, &cpus) != 0) outcome = Error{"no such CPU to pin to"};
  }
  if (schedule.priority > 0) {
    sched_param parameter{};
    parameter.sched_priority = schedule.priority;
    if (pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter) != 0 && outcome) {
      outcome = Error{"SCHED_FIFO not permitted (needs CAP_SYS_NICE or RLIMIT_RTPRIO)"};
    }
  }
  return outcome;
}

void hurry(pthread_t thread) {
  sched_param parameter{};
  parameter.sched_priority = sched_get_priority_min(SCHED_FIFO);
  pthread_setschedparam(thread, SCHED_FIFO, &parameter);
}

void keep_stacks_small() {
  pthread_attr_t thread_defaults;
  pthread_attr_init(&thread_defaults);
  pthread_attr_setstacksize(&thread_defaults, kThreadStackBytes);
  pthread_setattr_default_np(&thread_defaults);
  pthread_attr_destroy(&thread_defaults);
}

Result<void> lock_memory() {
  mallopt(M_TRIM_THRESHOLD, -1);

  // Under a finite limit MCL_FUTURE would turn later allocations into failures, so only what exists is locked then.
  rlimit limit{RLIM_INFINITY, RLIM_INFINITY};
  if (setrlimit(RLIMIT_MEMLOCK, &limit) != 0) getrlimit(RLIMIT_MEMLOCK, &limit);
  const bool unlimited = limit.rlim_cur == RLIM_INFINITY;
  if (mlockall(unlimited ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT) != 0) {
    return Error{"mlockall not permitted (needs CAP_IPC_LOCK or RLIMIT_MEMLOCK)"};
  }
  if (!unlimited) return Error{"RLIMIT_MEMLOCK is finite: only the memory of the start is locked"};
  return {};
}

Result<UniqueFd> limit_cpu_latency(int most_us, const char* device) {
  UniqueFd file{::open(device, O_WRONLY | O_CLOEXEC)};
  if (!file) return Error{"/dev/cpu_dma_latency cannot be opened: processors may idle deeply (needs its udev rule)"};
  const std::int32_t wanted = most_us;
  if (::write(file.get(), &wanted, sizeof wanted) != sizeof wanted) return Error{"/dev/cpu_dma_latency takes no limit"};
  return file;
}

}  // namespace slamd
