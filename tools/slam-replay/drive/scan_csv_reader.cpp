#include "tools/slam-replay/drive/scan_csv_reader.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "drivers/io/host_ns.hpp"

namespace slamd::replay {
namespace {

constexpr Duration kHostJump{1'000'000'000};  // a backward step beyond is a jump of the host's clock, not disorder

/// Cuts the text up to the next `mark` off `rest`; all of it when there is none.
std::string_view cut(std::string_view& rest, char mark) {
  const std::size_t at = rest.find(mark);
  const std::string_view head = rest.substr(0, at);
  rest.remove_prefix(at == std::string_view::npos ? rest.size() : at + 1);
  return head;
}

template <class Number>
bool parse_number(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

struct Head {
  std::int64_t t_ns = 0;
  double angle_begin_rad = 0.0, angle_step_rad = 0.0, beam_s = 0.0, range_max_m = 0.0;
};

Result<Head> parse_head(std::string_view& rest) {
  Head head;
  if (!parse_number(cut(rest, ','), head.t_ns) || !is_host_ns(head.t_ns)) return Error{"t_ns is no host time in ns"};
  for (double* value : {&head.angle_begin_rad, &head.angle_step_rad, &head.beam_s, &head.range_max_m}) {
    if (!parse_number(cut(rest, ','), *value) || !std::isfinite(*value)) return Error{"one of the columns 2 to 5 is no number"};
  }
  if (std::abs(head.angle_begin_rad) > 4 * std::numbers::pi) return Error{"angle_begin_rad is beyond two turns"};
  if (head.angle_step_rad == 0.0 || std::abs(head.angle_step_rad) > std::numbers::pi) return Error{"angle_step_rad is 0 or beyond half a turn"};
  if (head.beam_s < 0.0 || head.beam_s > 1.0) return Error{"beam_s is not within 0 and 1 s"};
  if (head.range_max_m <= 0.0 || head.range_max_m > 1000.0) return Error{"range_max_m is not within 0 and 1000 m"};
  if (rest.empty()) return Error{"has no ranges"};
  return head;
}

}  // namespace

std::optional<LaserScan> ScanCsvReader::next() {
  while (std::getline(lines_, line_)) {
    ++line_number_;
    std::string_view line{line_};
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line.starts_with("t_ns")) continue;
    Result<LaserScan> scan = parse(line);
    if (!scan) {
      bad_lines_.add(line_number_, scan.reason());
      continue;
    }
    newest_arrival_ = scan->arrival;
    return std::move(scan).value();
  }
  return std::nullopt;
}

Result<LaserScan> ScanCsvReader::parse(std::string_view rest) const {
  const Result<Head> head = parse_head(rest);
  if (!head) return Error{head.reason()};
  LaserScan scan;
  scan.arrival = from_ns<HostTime>(head->t_ns);
  scan.range_max_m = static_cast<float>(head->range_max_m);
  if (newest_arrival_ && scan.arrival < *newest_arrival_ && *newest_arrival_ - scan.arrival < kHostJump)
    return Error{"t_ns is before that of the scan above"};
  while (!rest.empty()) {
    float range = 0.0F;
    if (!parse_number(cut(rest, ';'), range)) return Error{"one of the ranges is no number"};
    if (scan.beams.size() == kMostBeams) return Error{"has more than 16384 ranges"};
    const auto beam = static_cast<double>(scan.beams.size());
    const bool returned = range > 0.0F && range <= scan.range_max_m;
    scan.beams.push_back({static_cast<float>(head->angle_begin_rad + head->angle_step_rad * beam), returned ? range : 0.0F,
                          static_cast<float>(head->beam_s * beam)});
  }
  const double duration_s = head->beam_s * static_cast<double>(scan.beams.size() - 1);
  if (duration_s > kLongestScanS) return Error{"beam_s and the number of ranges make more than 10 s"};
  scan.time = scan.arrival - from_seconds(duration_s);
  return scan;
}

}  // namespace slamd::replay
