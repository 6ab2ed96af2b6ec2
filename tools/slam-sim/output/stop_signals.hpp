#pragma once
// SIGINT and SIGTERM as a question instead of an interruption. Construct before any thread starts.

#include <csignal>
#include <ctime>

namespace slamd::sim {

class StopSignals {
 public:
  StopSignals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGINT);
    sigaddset(&set_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }
  /// True from the first signal on.
  bool pending() {
    const timespec none{};
    if (!seen_ && sigtimedwait(&set_, nullptr, &none) > 0) seen_ = true;
    return seen_;
  }

 private:
  sigset_t set_;
  bool seen_ = false;
};

}  // namespace slamd::sim
