#include "tools/imu-flash/program/progress_bar.hpp"

#include <unistd.h>

#include <cstdio>

namespace slamd::flash {

ProgressBar::ProgressBar() : terminal_{::isatty(STDERR_FILENO) == 1} {}

ProgressBar::~ProgressBar() {
  if (line_open_) std::fputc('\n', stderr);
}

void ProgressBar::show(const std::string& step, std::size_t done, std::size_t total) {
  constexpr std::size_t kWidth = 40;
  const std::size_t filled = total > 0 ? done * kWidth / total : kWidth;
  if (!terminal_ && done < total) return;
  if (line_open_ && step != step_) std::fputc('\n', stderr);
  step_ = step;
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, ' ');
  std::fprintf(stderr, "%s%-7s [%s] %3zu %%  %zu bytes", terminal_ ? "\r" : "", step.c_str(), bar.c_str(),
               total > 0 ? done * 100 / total : 100, done);
  line_open_ = done < total;
  if (!line_open_) std::fputc('\n', stderr);
}

}  // namespace slamd::flash
