#pragma once
// Reads /proc, /sys and /dev below a root folder, so that tests can bring a tree of their own. Judges nothing.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace slamd::doctor {

/// All reads give nothing where the file is absent or not readable. Paths are absolute, as on the real machine.
class HostFiles {
 public:
  explicit HostFiles(std::string root = "") : root_{std::move(root)} {}

  /// The whole content, at most 1 MiB.
  std::optional<std::string> text(const std::string& path) const;

  /// The first word.
  std::optional<std::string> word(const std::string& path) const;

  std::optional<std::int64_t> number(const std::string& path) const;

  /// What follows `key` on the line that begins with it, without blanks at both ends.
  std::optional<std::string> value_of(const std::string& path, const std::string& key) const;

  /// Names in the folder, sorted; empty where there is none.
  std::vector<std::string> names(const std::string& folder) const;

 private:
  std::string root_;
};

std::vector<std::string> lines_of(const std::string& text);
std::vector<std::string> words_of(const std::string& line);

/// The leading decimal number of a text.
std::optional<std::int64_t> to_number(const std::string& text);

/// Whether a kernel list such as "0,2-3" has `cpu`.
bool list_has(const std::string& list, int cpu);

}  // namespace slamd::doctor
