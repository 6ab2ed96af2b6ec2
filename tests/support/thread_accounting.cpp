#include "tests/support/thread_accounting.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <fstream>
#include <utility>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SLAMD_COUNTS 0
#else
#define SLAMD_COUNTS 1
#endif

namespace slamd {
namespace {

struct Slot {
  std::atomic<int> thread_id{0};
  std::atomic<std::uint64_t> allocations{0};
  std::atomic<std::uint64_t> frees{0};
  std::atomic<std::uint64_t> locks{0};
};

constexpr std::size_t kMaxThreads = 1024;
constinit std::array<Slot, kMaxThreads> slots{};
constinit std::atomic<std::size_t> slots_used{0};
constinit Slot spill{};  // threads beyond kMaxThreads share it
constinit thread_local Slot* own_slot = nullptr;

[[maybe_unused]] Slot& own() {
  if (own_slot == nullptr) {
    const std::size_t index = slots_used.fetch_add(1);
    own_slot = index < kMaxThreads ? &slots[index] : &spill;
    own_slot->thread_id.store(gettid());
  }
  return *own_slot;
}

std::string name_of(int thread_id) {
  std::ifstream file{"/proc/self/task/" + std::to_string(thread_id) + "/comm"};
  std::string name;
  std::getline(file, name);
  return name;
}

/// As the kernel counts them: fields 10 and 12 of stat, behind the name in brackets.
void read_faults(ThreadAccount& account) {
  std::ifstream file{"/proc/self/task/" + std::to_string(account.thread_id) + "/stat"};
  std::string skipped;
  std::getline(file, skipped, ')');
  for (int field = 3; field < 10; ++field) file >> skipped;
  file >> account.minor_faults >> skipped >> account.major_faults;
}

#if SLAMD_COUNTS
void count_allocation() {
  own().allocations.fetch_add(1, std::memory_order_relaxed);
}
void count_free() {
  own().frees.fetch_add(1, std::memory_order_relaxed);
}
void count_lock() {
  own().locks.fetch_add(1, std::memory_order_relaxed);
}

/// The library's own function of that name; found without any allocation or lock of ours after the first call.
template <class Function>
Function* next(std::atomic<Function*>& cached, const char* name) {
  Function* function = cached.load(std::memory_order_acquire);
  if (function == nullptr) {
    function = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
    cached.store(function, std::memory_order_release);
  }
  return function;
}
#endif

}  // namespace

bool thread_accounting_works() {
  return SLAMD_COUNTS == 1;
}

std::vector<ThreadAccount> thread_accounts() {
  std::vector<ThreadAccount> accounts;
  const std::size_t used = std::min(slots_used.load(), kMaxThreads);
  for (std::size_t i = 0; i < used; ++i) {
    const Slot& slot = slots[i];
    std::string name = name_of(slot.thread_id.load());
    if (name.empty()) continue;
    ThreadAccount& account = accounts.emplace_back(ThreadAccount{std::move(name), slot.thread_id.load()});
    account.allocations = slot.allocations.load();
    account.frees = slot.frees.load();
    account.locks = slot.locks.load();
    read_faults(account);
  }
  return accounts;
}

ThreadAccount thread_account(const std::string& name) {
  for (ThreadAccount& account : thread_accounts()) {
    if (account.name == name) return std::move(account);
  }
  return {name};
}

}  // namespace slamd

#if SLAMD_COUNTS
// glibc's allocator under its other names; what follows takes the place of the usual ones in the whole process.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
  slamd::count_allocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  slamd::count_allocation();
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  slamd::count_allocation();
  return __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  slamd::count_allocation();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  slamd::count_allocation();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  slamd::count_allocation();
  *block = __libc_memalign(alignment, size);
  return *block != nullptr ? 0 : ENOMEM;
}
void free(void* block) {
  if (block != nullptr) slamd::count_free();
  __libc_free(block);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  static constinit std::atomic<int (*)(pthread_mutex_t*)> real{nullptr};
  slamd::count_lock();
  return slamd::next(real, "pthread_mutex_lock")(mutex);
}
int pthread_mutex_trylock(pthread_mutex_t* mutex) {
  static constinit std::atomic<int (*)(pthread_mutex_t*)> real{nullptr};
  slamd::count_lock();
  return slamd::next(real, "pthread_mutex_trylock")(mutex);
}
int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* until) {
  static constinit std::atomic<int (*)(pthread_mutex_t*, const timespec*)> real{nullptr};
  slamd::count_lock();
  return slamd::next(real, "pthread_mutex_timedlock")(mutex, until);
}
int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock, const timespec* until) {
  static constinit std::atomic<int (*)(pthread_mutex_t*, clockid_t, const timespec*)> real{nullptr};
  slamd::count_lock();
  return slamd::next(real, "pthread_mutex_clocklock")(mutex, clock, until);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* lock) {
  static constinit std::atomic<int (*)(pthread_rwlock_t*)> real{nullptr};
  slamd::count_lock();
  return slamd::next(real, "pthread_rwlock_rdlock")(lock);
}
int pthread_rwlock_wrlock(pthread_rwlock_t* lock) {
  static constinit std::atomic<int (*)(pthread_rwlock_t*)> real{nullptr};
  slamd::count_lock();
  return slamd::next(real, "pthread_rwlock_wrlock")(lock);
}
}
#endif
