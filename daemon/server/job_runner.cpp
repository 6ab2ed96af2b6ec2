#include "daemon/server/job_runner.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <boost/asio/post.hpp>
#include <exception>
#include <utility>

#include "daemon/server/host_clock.hpp"
#include "daemon/server/protocol/protocol.hpp"

namespace slamd {
namespace {

constexpr int kNice = 10;  // two hundred clients that ask for maps must not keep the mapping thread from its processor

void stand_back() {
  pthread_setname_np(pthread_self(), "slamd-jobs");
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);  // on Linux of the thread alone
}

}  // namespace

JobRunner::JobRunner(boost::asio::io_context& io, std::size_t max_jobs) : io_{io}, max_jobs_{max_jobs} {
  boost::asio::post(pool_, stand_back);
}

bool JobRunner::submit(Job job, Ticket ticket) {
  if (jobs_ >= max_jobs_) return false;
  ++jobs_;
  boost::asio::post(pool_, [this, job = std::move(job), ticket = std::move(ticket)]() mutable {
    Outcome outcome = run(job, ticket);
    boost::asio::post(io_, [this, outcome = std::move(outcome), done = std::move(ticket.done)]() mutable {
      --jobs_;
      done(std::move(outcome));
    });
  });
  return true;
}

Outcome JobRunner::run(const Job& job, const Ticket& ticket) {
  constexpr Duration kProgressPeriod = std::chrono::milliseconds{100};
  HostTime told = host_now();
  const JobProgress progress = [&](const char* stage, double share) {
    const HostTime now = host_now();
    if (ticket.progress && now - told >= kProgressPeriod) {
      told = now;
      boost::asio::post(io_, [tell = ticket.progress, stage, share] { tell(stage, share); });
    }
    return !stopping_.load(std::memory_order_relaxed) && !ticket.cancelled->load(std::memory_order_relaxed);
  };
  try {
    return job.work(progress);
  } catch (const std::exception&) {  // no memory for the map
    return RpcError{protocol::error::kInternal, "the job failed, probably for want of memory"};
  }
}

void JobRunner::stop() {
  stopping_.store(true, std::memory_order_relaxed);
  pool_.stop();
  pool_.join();
}

}  // namespace slamd
