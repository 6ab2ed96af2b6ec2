#pragma once
// Turns states that are looked at again and again into lines about their changes, so many in a period at most. It
// decides no state and reads no clock.

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "daemon/threads/log.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

/// How something stands now. Two conditions differ when level or state differ; the details may be of the moment.
struct Condition {
  LogLevel level = LogLevel::kInfo;
  std::string state;    // "state=healthy"
  std::string details;  // " rate_hz=200", may be empty
};

class ChangeLog {
 public:
  using Sink = std::function<void(LogLevel, const std::string&)>;

  /// repeat_period  a subject gets one line at once, the next ones at least so far apart
  ChangeLog(Duration repeat_period, Sink sink) : repeat_period_{repeat_period}, sink_{std::move(sink)} {}

  /// Writes "subject state details" when the condition is another one than the subject's last line told, unless a line
  /// about it was written less than repeat_period ago: then the newest condition waits, and the line that comes says
  /// how many changes there were in between ("changes=7"). Call it with every look.
  void look(const std::string& subject, const Condition& now, HostTime at);

  void set_repeat_period(Duration period) { repeat_period_ = period; }

 private:
  struct Subject {
    bool told = false;
    Condition seen;       // at the last look
    Condition last_line;  // as the last line told
    HostTime told_at;
    std::uint64_t changes = 0;  // since the last line
  };

  Duration repeat_period_;
  Sink sink_;
  std::map<std::string, Subject> subjects_;
};

}  // namespace slamd
