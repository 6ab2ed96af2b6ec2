#pragma once
// Counts, for every thread of the test's process, the heap allocations, mutex locks and page faults it makes: the test binary's own
// malloc and pthread_mutex_lock stand before the libraries'. Linking slamd::thread_accounting is all it takes.

#include <cstdint>
#include <string>
#include <vector>

namespace slamd {

struct ThreadAccount {
  std::string name;  // as set with pthread_setname_np
  int thread_id = 0;
  std::uint64_t allocations = 0;  // malloc, calloc, realloc, aligned forms, operator new
  std::uint64_t frees = 0;
  std::uint64_t locks = 0;  // pthread_mutex_lock, _trylock, _timedlock, _clocklock; read-write locks
  std::uint64_t minor_faults = 0;  // pages that the kernel had to map
  std::uint64_t major_faults = 0;  // pages that it had to read from a disk
};

/// False under address or thread sanitizer, which have allocators of their own: nothing is counted then.
bool thread_accounting_works();

/// Totals of every thread that is alive and has done any of it.
std::vector<ThreadAccount> thread_accounts();

/// Totals of the thread of that name; zeros when there is none.
ThreadAccount thread_account(const std::string& name);

}  // namespace slamd
