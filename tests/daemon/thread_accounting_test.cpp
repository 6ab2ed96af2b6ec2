#include "tests/support/thread_accounting.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <vector>

#include "daemon/threads/worker.hpp"

namespace slamd {
namespace {

class ThreadAccounting : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!thread_accounting_works()) GTEST_SKIP() << "the sanitizer has its own allocator";
  }
};

/// What body() does on a thread of its own.
template <class Body>
ThreadAccount account_of(Body body) {
  std::atomic<bool> ready{false};
  Worker worker{{"slamd-counted"}, [&](const std::stop_token& stop) {
                  body();
                  ready = true;
                  while (!stop.stop_requested()) std::this_thread::yield();
                }};
  while (!ready) std::this_thread::yield();
  return thread_account("slamd-counted");
}

TEST_F(ThreadAccounting, AThreadThatOnlyComputesHasNothingOnItsAccount) {
  const ThreadAccount before = account_of([] {});
  volatile double x = 1.0;
  const ThreadAccount account = account_of([&] {
    for (int i = 0; i < 1000; ++i) x = x * 1.0001;
  });
  EXPECT_EQ(account.allocations, before.allocations);
  EXPECT_EQ(account.locks, before.locks);
}

TEST_F(ThreadAccounting, EveryKindOfAllocationIsCounted) {
  const ThreadAccount before = account_of([] {});
  const ThreadAccount account = account_of([] {
    std::vector<int> values(100);
    values[0] = 1;
    auto aligned = std::make_unique<std::max_align_t[]>(8);
    void* block = std::malloc(10);  // NOLINT
    block = std::realloc(block, 100);
    std::free(block);
    std::free(std::aligned_alloc(64, 128));
  });
  EXPECT_GE(account.allocations - before.allocations, 4U);
}

TEST_F(ThreadAccounting, LocksAreCounted) {
  const ThreadAccount before = account_of([] {});
  std::mutex mutex;
  const ThreadAccount account = account_of([&] {
    for (int i = 0; i < 10; ++i) const std::scoped_lock lock{mutex};
  });
  EXPECT_EQ(account.locks - before.locks, 10U);
}

TEST_F(ThreadAccounting, LocksThatGiveUpAreCountedToo) {
  const ThreadAccount before = account_of([] {});
  std::timed_mutex mutex;
  const ThreadAccount account = account_of([&] {
    if (mutex.try_lock_for(std::chrono::milliseconds{1})) mutex.unlock();
    if (mutex.try_lock()) mutex.unlock();
  });
  EXPECT_EQ(account.locks - before.locks, 2U);
}

TEST_F(ThreadAccounting, PagesThatWereNotThereAreCounted) {
  constexpr std::size_t kPages = 100, kBytes = kPages * 4096;
  std::mutex mutex;  // what is locked gives the thread an account
  const ThreadAccount before = account_of([&] { const std::scoped_lock lock{mutex}; });
  const ThreadAccount account = account_of([&] {
    const std::scoped_lock lock{mutex};
    auto* pages = static_cast<volatile char*>(::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    ::madvise(const_cast<char*>(pages), kBytes, MADV_NOHUGEPAGE);
    for (std::size_t i = 0; i < kBytes; i += 4096) pages[i] = 1;
    ::munmap(const_cast<char*>(pages), kBytes);
  });
  EXPECT_GE(account.minor_faults, before.minor_faults + kPages);
}

}  // namespace
}  // namespace slamd
