#include "daemon/threads/log.hpp"

#include <spdlog/async.h>
#include <spdlog/sinks/stdout_sinks.h>

namespace slamd {

Log::Log(const LogConfig& config) : pool_{std::make_shared<spdlog::details::thread_pool>(config.queue_lines, 1)} {
  logger_ = std::make_shared<spdlog::async_logger>("slamd", std::make_shared<spdlog::sinks::stderr_sink_mt>(), pool_,
                                                   spdlog::async_overflow_policy::overrun_oldest);
  logger_->set_pattern("%Y-%m-%dT%H:%M:%S.%e %l %v");
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
