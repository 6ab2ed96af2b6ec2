#define SD_JOURNAL_SUPPRESS_LOCATION  // it would be this file's in every line
#include "daemon/threads/journal_sink.hpp"

#include <spdlog/details/null_mutex.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <systemd/sd-journal.h>
#include <syslog.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace slamd {
namespace {

int priority(spdlog::level::level_enum level) {
  return level >= spdlog::level::err ? LOG_ERR : level == spdlog::level::warn ? LOG_WARNING : LOG_INFO;
}

std::string field_name(std::string_view key) {
  std::string name = "SLAMD_";
  for (const char c : key) {
    const auto byte = static_cast<unsigned char>(c);
    name += std::isalnum(byte) != 0 ? static_cast<char>(std::toupper(byte)) : '_';
  }
  return name;
}

/// Takes the value off the front of `rest`: up to the line's last quotation mark, or to the next blank without punctuation.
std::string_view take_value(std::string_view& rest) {
  const bool quoted = rest.starts_with('"');
  if (quoted) rest.remove_prefix(1);
  const std::size_t end = std::min(quoted ? rest.rfind('"') : rest.find(' '), rest.size());
  std::string_view value = rest.substr(0, end);
  rest.remove_prefix(end);
  while (!quoted && (value.ends_with(',') || value.ends_with(':'))) value.remove_suffix(1);
  return value;
}

}  // namespace

bool stderr_is_journal() {
  const char* const stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  if (stream == nullptr || ::fstat(STDERR_FILENO, &status) != 0) return false;
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino) == stream;
}

std::vector<std::string> journal_fields(std::string_view line) {
  const std::size_t subject_end = std::min(line.find(' '), line.size());
  std::vector<std::string> fields{"SLAMD_SUBJECT=" + std::string{line.substr(0, subject_end)}};
  std::string_view rest = line.substr(subject_end);
  while (!rest.empty()) {
    const std::size_t word = rest.find_first_not_of(' ');
    if (word == std::string_view::npos) break;
    rest.remove_prefix(word);
    const std::size_t end = std::min(rest.find(' '), rest.size());
    const std::size_t equals = rest.find('=');
    if (equals == 0 || equals >= end) {
      rest.remove_prefix(end);
      continue;
    }
    const std::string name = field_name(rest.substr(0, equals));
    rest.remove_prefix(equals + 1);
    fields.push_back(name + "=" + std::string{take_value(rest)});
  }
  return fields;
}

void JournalSink::sink_it_(const spdlog::details::log_msg& message) {
  const std::string_view line{message.payload.data(), message.payload.size()};
  std::vector<std::string> fields = journal_fields(line);
  fields.push_back("MESSAGE=" + std::string{line});
  fields.push_back("PRIORITY=" + std::to_string(priority(message.level)));
  fields.emplace_back("SYSLOG_IDENTIFIER=slamd");
  std::vector<iovec> parts;
  parts.reserve(fields.size());
  for (std::string& field : fields) parts.push_back({field.data(), field.size()});
  sd_journal_sendv(parts.data(), static_cast<int>(parts.size()));
}

}  // namespace slamd
