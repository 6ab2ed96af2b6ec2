#pragma once
// What was wrong with the lines of a text file of a drive: how many were skipped, and where and why the first one was.

#include <cstdint>
#include <string>

namespace slamd::replay {

struct BadLines {
  std::uint64_t count = 0;
  std::uint64_t first_line = 0;      // from 1, the header included
  const char* first_reason = "";

  void add(std::uint64_t line, const char* reason) {
    if (count++ > 0) return;
    first_line = line;
    first_reason = reason;
  }
  /// "PATH:LINE: reason (N lines skipped)".
  std::string text(const std::string& path) const {
    return path + ":" + std::to_string(first_line) + ": " + first_reason + " (" + std::to_string(count) +
           (count == 1 ? " line skipped)" : " lines skipped)");
  }
};

}  // namespace slamd::replay
