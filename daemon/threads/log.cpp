#include "daemon/threads/log.hpp"

#include <spdlog/async.h>
#include <spdlog/sinks/stdout_sinks.h>

#include "daemon/threads/journal_sink.hpp"

namespace slamd {
namespace {

spdlog::sink_ptr make_sink() {
  if (stderr_is_journal()) return std::make_shared<JournalSink>();
  auto sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  sink->set_pattern("%Y-%m-%dT%H:%M:%S.%e %l %v");
  return sink;
}

}  // namespace

Log::Log(const LogConfig& config) : pool_{std::make_shared<spdlog::details::thread_pool>(config.queue_lines, 1)} {
  logger_ = std::make_shared<spdlog::async_logger>("slamd", make_sink(), pool_,
                                                   spdlog::async_overflow_policy::overrun_oldest);
  logger_->flush_on(spdlog::level::info);
}

Log::~Log() { pool_.reset(); }  // joins the writing thread while the logger that it uses is still there

void Log::write(LogLevel level, std::string_view line) {
  const auto spdlog_level = level == LogLevel::kInfo      ? spdlog::level::info
                            : level == LogLevel::kWarning ? spdlog::level::warn
                                                          : spdlog::level::err;
  logger_->log(spdlog_level, "{}", line);
}

std::uint64_t Log::lost() const {
  return pool_->overrun_counter();
}

}  // namespace slamd
