#include "tools/slam-replay/drive/gps_csv_reader.hpp"

#include <charconv>
#include <span>

#include "drivers/io/host_ns.hpp"

namespace slamd::replay {

std::optional<GnssFix> GpsCsvReader::next() {
  while (fixes_.empty() && read_line()) {
  }
  if (fixes_.empty()) return std::nullopt;
  const GnssFix fix = fixes_.front();
  fixes_.pop_front();
  return fix;
}

bool GpsCsvReader::read_line() {
  const auto keep = [this](const GnssFix& fix) { fixes_.push_back(fix); };
  if (!std::getline(lines_, line_)) {
    if (!ended_) parser_.finish(keep);
    ended_ = true;
    return false;
  }
  if (line_.starts_with("t_ns")) return true;
  std::int64_t arrival_ns = 0;
  const char* const end = line_.data() + line_.size();
  const auto [rest, error] = std::from_chars(line_.data(), end, arrival_ns);
  if (error != std::errc{} || rest == end || *rest != ',' || !is_host_ns(arrival_ns)) {
    ++bad_lines_;
    return true;
  }
  const std::string sentence = std::string(rest + 1, end) + "\r\n";
  const std::span bytes{reinterpret_cast<const std::uint8_t*>(sentence.data()), sentence.size()};
  parser_.feed(bytes, from_ns<HostTime>(arrival_ns), keep);
  return true;
}

}  // namespace slamd::replay
