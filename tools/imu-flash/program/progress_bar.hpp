#pragma once
// One bar a step on stderr: "write  [########      ]  53 %". On no terminal one line when a step is done. It measures
// no time: tools/progress does, for drives.

#include <cstddef>
#include <string>

namespace slamd::flash {

class ProgressBar {
 public:
  ProgressBar();
  /// Ends an unfinished line.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(const std::string& step, std::size_t done, std::size_t total);

 private:
  bool terminal_;
  bool line_open_ = false;
  std::string step_;
};

}  // namespace slamd::flash
