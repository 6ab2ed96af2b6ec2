#pragma once
// One line on stderr that says how far a long work is. Silent when asked; whole lines when stderr is no terminal.

#include <chrono>
#include <string>

namespace slamd {

class Progress {
 public:
  /// unit  of `total`; seconds of a drive are also told as a multiple of real time, an empty unit as the share alone
  Progress(std::string what, double total, bool quiet, std::string unit = "s");

  /// `note` stands at the end of the line. Prints at most every 0.2 s (10 s without a terminal).
  void show(double done, const std::string& note = {});
  void finish(const std::string& message);

 private:
  std::string amount(double done, double elapsed_s) const;

  std::string what_;
  double total_;
  std::string unit_;
  bool quiet_;
  bool terminal_;
  std::chrono::steady_clock::time_point begin_, next_;
};

}  // namespace slamd
