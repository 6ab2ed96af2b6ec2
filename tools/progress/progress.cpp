#include "tools/progress/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace slamd {

using Clock = std::chrono::steady_clock;

Progress::Progress(std::string what, double total_s, bool quiet)
    : what_{std::move(what)},
      total_s_{total_s},
      quiet_{quiet},
      terminal_{::isatty(STDERR_FILENO) == 1},
      begin_{Clock::now()},
      next_{begin_} {}

void Progress::show(double done_s, const std::string& note) {
  const auto now = Clock::now();
  if (quiet_ || now < next_) return;
  next_ = now + (terminal_ ? std::chrono::milliseconds{200} : std::chrono::milliseconds{10'000});
  const double elapsed = std::chrono::duration<double>(now - begin_).count();
  const double share = total_s_ > 0.0 ? std::clamp(done_s / total_s_, 0.0, 1.0) : 1.0;
  const double left = share > 0.0 ? elapsed * (1.0 - share) / share : 0.0;
  std::string bar(30, ' ');
  std::fill_n(bar.begin(), static_cast<int>(share * 30), '#');
  std::fprintf(stderr, "%s%s [%s] %3.0f %%  %.1f/%.1f s  %.1fx real time  ETA %.0f s  %s%s", terminal_ ? "\r" : "",
               what_.c_str(), bar.c_str(), 100.0 * share, done_s, total_s_, elapsed > 0.0 ? done_s / elapsed : 0.0,
               left, note.c_str(), terminal_ ? "\x1b[K" : "\n");
}

void Progress::finish(const std::string& message) {
  if (!quiet_) std::fprintf(stderr, "%s%s\n", terminal_ ? "\r\x1b[K" : "", message.c_str());
}

}  // namespace slamd
