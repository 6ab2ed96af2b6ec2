#include "daemon/threads/worker.hpp"

#include <utility>

namespace slamd {

Worker::Worker(const ThreadSchedule& schedule, Body body)
    : schedule_{schedule}, thread_{[this, body = std::move(body)](const std::stop_token& stop) { run(stop, body); }} {
  running_.wait(false, std::memory_order_acquire);
}

void Worker::hurry() {
  if (schedule_.priority == 0) slamd::hurry(thread_.native_handle());
}

void Worker::run(const std::stop_token& stop, const Body& body) {
  scheduled_ = enter_schedule(schedule_);
  running_.store(true, std::memory_order_release);
  running_.notify_one();
  try {
    body(stop);
  } catch (...) {
    failed_.store(true, std::memory_order_relaxed);
  }
}

}  // namespace slamd
