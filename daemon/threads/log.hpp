#pragma once
// The daemon's log: one line one event, to stderr or, where that ends in the journal, there with fields; through a queue
// that never blocks and loses its oldest lines when full. Not for real-time threads: they count, and the supervisor tells.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

#include "estimator/types/time.hpp"

namespace spdlog {
class logger;
namespace details {
class thread_pool;
}
}  // namespace spdlog

namespace slamd {

struct LogConfig {
  std::size_t queue_lines = 1024;
  Duration repeat_period = std::chrono::seconds{5};  // a subject that changes more often is told so often only
};

enum class LogLevel { kInfo, kWarning, kError };

class Log {
 public:
  explicit Log(const LogConfig& config);
  ~Log();  // writes what waits

  /// Any thread that is not real-time. `line` is an event's name, then key=value pairs.
  void write(LogLevel level, std::string_view line);

  /// Lines lost because the queue was full.
  std::uint64_t lost() const;

 private:
  std::shared_ptr<spdlog::details::thread_pool> pool_;
  std::shared_ptr<spdlog::logger> logger_;
};

}  // namespace slamd
