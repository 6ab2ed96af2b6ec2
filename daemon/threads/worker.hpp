#pragma once
// One named thread of the daemon under its schedule: started, asked to stop, joined. Not a pool; it runs one body once.

#include <atomic>
#include <functional>
#include <thread>

#include "daemon/threads/real_time.hpp"

namespace slamd {

class Worker {
 public:
  using Body = std::function<void(const std::stop_token&)>;

  /// Starts the thread and returns once it is scheduled. The body must return within a second after a stop request;
  /// an exception that it lets through ends the thread and is seen by failed().
  Worker(const ThreadSchedule& schedule, Body body);
  ~Worker() = default;  // requests the stop and joins

  void request_stop() { thread_.request_stop(); }
  /// For the end of the daemon: a thread without a priority gets one, where that is permitted, so that what it still has to write is
  /// not kept waiting by a busy machine.
  void hurry();
  const char* name() const { return schedule_.name; }
  /// What the kernel did not grant of the schedule, if anything.
  const Result<void>& scheduled() const { return scheduled_; }
  /// Any thread: the body ended by an exception.
  bool failed() const { return failed_.load(std::memory_order_relaxed); }

 private:
  void run(const std::stop_token& stop, const Body& body);

  const ThreadSchedule schedule_;
  Result<void> scheduled_;
  std::atomic<bool> running_{false};
  std::atomic<bool> failed_{false};
  std::jthread thread_;  // last: it starts when all above exists, and is joined before any of it goes
};

}  // namespace slamd
