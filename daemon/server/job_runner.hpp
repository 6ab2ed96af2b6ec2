#pragma once
// Runs the slow jobs one after the other on a thread of its own and brings their outcome back to the server's thread.
// Bounded: a job too many is refused, not queued. Maps for clients come after all other work of the daemon.

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>
#include <cstddef>
#include <functional>
#include <memory>

#include "daemon/server/methods.hpp"

namespace slamd {

class JobRunner {
 public:
  /// io  the server's loop, on which `done` and `progress` are called
  JobRunner(boost::asio::io_context& io, std::size_t max_jobs);
  ~JobRunner() { stop(); }

  struct Ticket {
    std::shared_ptr<const std::atomic<bool>> cancelled;  // set when nobody waits for the outcome any more
    std::function<void(Outcome)> done;
    std::function<void(const char* stage, double share)> progress;  // empty: not wanted
  };
  /// Server's thread. False when max_jobs are in work or waiting.
  bool submit(Job job, Ticket ticket);

  /// Interrupts the job in work, forgets the others, ends the thread.
  void stop();

 private:
  Outcome run(const Job& job, const Ticket& ticket);

  boost::asio::io_context& io_;
  const std::size_t max_jobs_;
  std::size_t jobs_ = 0;  // server's thread
  std::atomic<bool> stopping_{false};
  boost::asio::thread_pool pool_{1};
};

}  // namespace slamd
