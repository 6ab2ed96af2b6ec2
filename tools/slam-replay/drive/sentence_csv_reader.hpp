#pragma once
// Reads gps.csv and wheel.csv of a drive folder: lines "t_ns,sentence", the sentences through the driver's parser. The recorded
// bytes of a port are wire_reader's.

#include <charconv>
#include <deque>
#include <istream>
#include <optional>
#include <span>
#include <string>

#include "drivers/io/host_ns.hpp"
#include "estimator/types/time.hpp"
#include "tools/slam-replay/drive/bad_lines.hpp"

namespace slamd::replay {

/// Parser: NmeaParser or WheelParser. Item: what it makes.
template <class Parser, class Item>
class SentenceCsvReader {
 public:
  /// `lines` must outlive the reader.
  template <class Config>
  SentenceCsvReader(std::istream& lines, const Config& config) : lines_{lines}, parser_{config} {}

  /// The next item, or nothing at the end. Bad lines are counted and skipped; what is wrong with a sentence the parser counts.
  std::optional<Item> next() {
    while (items_.empty() && read_line()) {
    }
    if (items_.empty()) return std::nullopt;
    const Item item = items_.front();
    items_.pop_front();
    return item;
  }

  const Parser& parser() const { return parser_; }
  const BadLines& bad_lines() const { return bad_lines_; }

 private:
  bool read_line() {
    if (!std::getline(lines_, line_)) {
      finish();
      return false;
    }
    ++line_number_;
    if (line_.empty() || line_.starts_with("t_ns")) return true;
    std::int64_t arrival_ns = 0;
    const char* const end = line_.data() + line_.size();
    const auto [rest, error] = std::from_chars(line_.data(), end, arrival_ns);
    if (error != std::errc{} || rest == end || *rest != ',' || !is_host_ns(arrival_ns)) {
      bad_lines_.add(line_number_, "does not begin with a host time in ns and a comma");
      return true;
    }
    const std::string sentence = std::string(rest + 1, end) + "\r\n";
    const std::span bytes{reinterpret_cast<const std::uint8_t*>(sentence.data()), sentence.size()};
    parser_.feed(bytes, from_ns<HostTime>(arrival_ns), [this](const Item& item) { items_.push_back(item); });
    return true;
  }

  /// What the parser still held back.
  void finish() {
    const auto keep = [this](const Item& item) { items_.push_back(item); };
    if constexpr (requires { parser_.finish(keep); }) {
      if (!ended_) parser_.finish(keep);
    }
    ended_ = true;
  }

  std::istream& lines_;
  Parser parser_;
  std::string line_;
  std::uint64_t line_number_ = 0;
  std::deque<Item> items_;
  BadLines bad_lines_;
  bool ended_ = false;
};

}  // namespace slamd::replay
