#include "tools/progress/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>

namespace slamd {

using Clock = std::chrono::steady_clock;

Progress::Progress(std::string what, double total, bool quiet, std::string unit)
    : what_{std::move(what)},
      total_{total},
      unit_{std::move(unit)},
      quiet_{quiet},
      terminal_{::isatty(STDERR_FILENO) == 1},
      begin_{Clock::now()},
      next_{begin_} {}

std::string Progress::amount(double done, double elapsed_s) const {
  std::array<char, 96> text{};
  if (unit_ == "s") {
    const double factor = elapsed_s > 0.0 ? done / elapsed_s : 0.0;
    std::snprintf(text.data(), text.size(), "  %.1f/%.1f s  %.1fx real time", done, total_, factor);
  } else if (!unit_.empty()) {
    std::snprintf(text.data(), text.size(), "  %.0f/%.0f %s", done, total_, unit_.c_str());
  }
  return text.data();
}

void Progress::show(double done, const std::string& note) {
  const auto now = Clock::now();
  if (quiet_ || now < next_) return;
  next_ = now + (terminal_ ? std::chrono::milliseconds{200} : std::chrono::milliseconds{10'000});
  const double elapsed = std::chrono::duration<double>(now - begin_).count();
  const double share = total_ > 0.0 ? std::clamp(done / total_, 0.0, 1.0) : 1.0;
  const double left = share > 0.0 ? elapsed * (1.0 - share) / share : 0.0;
  std::string bar(30, ' ');
  std::fill_n(bar.begin(), static_cast<int>(share * 30), '#');
  std::fprintf(stderr, "%s%s [%s] %3.0f %%%s  ETA %.0f s  %s%s", terminal_ ? "\r" : "", what_.c_str(), bar.c_str(),
               100.0 * share, amount(done, elapsed).c_str(), left, note.c_str(), terminal_ ? "\x1b[K" : "\n");
}

void Progress::finish(const std::string& message) {
  if (!quiet_) std::fprintf(stderr, "%s%s\n", terminal_ ? "\r\x1b[K" : "", message.c_str());
}

}  // namespace slamd
