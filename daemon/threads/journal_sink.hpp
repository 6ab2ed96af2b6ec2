#pragma once
// The log's way into the systemd journal: each line with its key=value pairs as fields of their own. Not for terminals.

#include <spdlog/sinks/base_sink.h>

#include <string>
#include <string_view>
#include <vector>

namespace slamd {

/// Does what this process writes to stderr end in the journal?
bool stderr_is_journal();

/// "imu state=absent, continuing without: device=/dev/ttyACM0" as SLAMD_SUBJECT=imu, SLAMD_STATE=absent,
/// SLAMD_DEVICE=/dev/ttyACM0. Quotation marks around a value and the comma after it are no part of it.
std::vector<std::string> journal_fields(std::string_view line);

class JournalSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {  // one thread: the log's
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override {}
};

}  // namespace slamd
