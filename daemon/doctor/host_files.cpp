#include "daemon/doctor/host_files.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

namespace slamd::doctor {

std::optional<std::string> HostFiles::text(const std::string& path) const {
  constexpr std::size_t kMaxBytes = 1 << 20;
  std::ifstream file{root_ + path, std::ios::binary};
  std::string content(4096, '\0');
  std::size_t size = 0;
  while (file && size < kMaxBytes) {
    content.resize(size + 4096);
    file.read(content.data() + size, 4096);
    size += static_cast<std::size_t>(file.gcount());
  }
  if (size == 0) return std::nullopt;  // the kernel's files are never empty when they can be read
  content.resize(size);
  return content;
}

std::optional<std::string> HostFiles::word(const std::string& path) const {
  const std::vector<std::string> words = words_of(text(path).value_or(""));
  return words.empty() ? std::nullopt : std::optional{words.front()};
}

std::optional<std::int64_t> HostFiles::number(const std::string& path) const {
  return to_number(word(path).value_or(""));
}

std::optional<std::string> HostFiles::value_of(const std::string& path, const std::string& key) const {
  for (const std::string& line : lines_of(text(path).value_or(""))) {
    if (!line.starts_with(key)) continue;
    const std::size_t begin = line.find_first_not_of(" \t", key.size());
    if (begin == std::string::npos) return "";
    return line.substr(begin, line.find_last_not_of(" \t") - begin + 1);
  }
  return std::nullopt;
}

std::vector<std::string> HostFiles::names(const std::string& folder) const {
  std::vector<std::string> found;
  std::error_code fault;
  std::filesystem::directory_iterator entry{root_ + folder, fault};
  while (!fault && entry != std::filesystem::directory_iterator{}) {
    found.push_back(entry->path().filename());
    entry.increment(fault);
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream{text};
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream{line};
  return {std::istream_iterator<std::string>{stream}, {}};
}

std::optional<std::int64_t> to_number(const std::string& text) {
  std::int64_t value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc{} ? std::optional{value} : std::nullopt;
}

bool list_has(const std::string& list, int cpu) {
  std::istringstream stream{list};
  for (std::string range; std::getline(stream, range, ',');) {
    const std::optional<std::int64_t> first = to_number(range);
    const std::size_t dash = range.find('-');
    const std::optional<std::int64_t> last = dash == std::string::npos ? first : to_number(range.substr(dash + 1));
    if (first && last && *first <= cpu && cpu <= *last) return true;
  }
  return false;
}

}  // namespace slamd::doctor
