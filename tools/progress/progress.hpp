#pragma once
// One line on stderr that says how far a drive is. Silent when asked; whole lines when stderr is no terminal.

#include <chrono>
#include <string>

namespace slamd {

class Progress {
 public:
  Progress(std::string what, double total_s, bool quiet);

  /// done_s of the drive; `note` stands at the end of the line. Prints at most every 0.2 s (10 s without a terminal).
  void show(double done_s, const std::string& note = {});
  void finish(const std::string& message);

 private:
  std::string what_;
  double total_s_;
  bool quiet_;
  bool terminal_;
  std::chrono::steady_clock::time_point begin_, next_;
};

}  // namespace slamd
