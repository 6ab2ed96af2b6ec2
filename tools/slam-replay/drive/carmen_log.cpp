#include "tools/slam-replay/drive/carmen_log.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "tools/slam-replay/drive/carmen_line.hpp"

namespace slamd::replay {
namespace {

constexpr std::size_t kMostRecords = 5'000'000;
constexpr std::size_t kLongestLine = 1 << 18;
constexpr std::size_t kFaultsTold = 10;
constexpr Duration kStampStep = std::chrono::microseconds{1};  // between two records that would have one stamp

struct GzClose {
  void operator()(gzFile file) const { gzclose(file); }
};

/// Lines of a file, packed or not. A line that is too long is cut, and then is no record.
class Lines {
 public:
  explicit Lines(const std::string& path) : file_{gzopen(path.c_str(), "rb")} {}

  bool is_open() const { return file_ != nullptr; }
  bool next(std::string& line) {
    line.clear();
    std::array<char, 4096> piece;
    while (gzgets(file_.get(), piece.data(), piece.size()) != nullptr) {
      if (line.size() < kLongestLine) line += piece.data();
      if (line.ends_with('\n')) {
        line.pop_back();
        return true;
      }
    }
    return !line.empty();
  }
  /// Why it ended before its end; null when it did not.
  const char* damage() {
    int code = Z_OK;
    const char* text = gzerror(file_.get(), &code);
    return code == Z_OK || code == Z_STREAM_END ? nullptr : (code == Z_BUF_ERROR ? "the file is cut off" : text);
  }

 private:
  std::unique_ptr<gzFile_s, GzClose> file_;
};

struct Record {
  HostTime stamp;
  CarmenRecord content;
};

void note(CarmenLog& log, const std::string& path, std::uint64_t line, const char* reason) {
  if (log.faults.size() < kFaultsTold) log.faults.push_back(path + ":" + std::to_string(line) + ": " + reason);
}

std::vector<Record> read_records(Lines& lines, const std::string& path, CarmenLog& log) {
  std::vector<Record> records;
  std::string text;
  std::uint64_t number = 0;
  while (records.size() < kMostRecords && lines.next(text)) {
    ++number;
    CarmenLine line = parse_carmen_line(text);
    if (line.laser_forward_m) log.laser_forward_m = *line.laser_forward_m;
    if (line.reason != nullptr) {
      ++log.bad_lines;
      note(log, path, number, line.reason);
    }
    if (line.record) records.push_back({HostTime{from_seconds(line.record->time_s)}, std::move(*line.record)});
  }
  if (const char* reason = lines.damage()) note(log, path, number, reason);
  return records;
}

/// The longest run of records, gaps allowed, whose stamps never step back: those are believed.
std::vector<std::size_t> steady(const std::vector<Record>& records) {
  std::vector<std::size_t> ends;  // of the shortest-tailed run of each length
  std::vector<std::size_t> before(records.size(), records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const auto at = std::ranges::upper_bound(ends, records[i].stamp, {}, [&](std::size_t j) { return records[j].stamp; });
    if (at != ends.begin()) before[i] = *std::prev(at);
    if (at == ends.end()) ends.push_back(i); else *at = i;
  }
  std::vector<std::size_t> run;
  for (std::size_t i = ends.empty() ? records.size() : ends.back(); i < records.size(); i = before[i]) run.push_back(i);
  std::ranges::reverse(run);
  return run;
}

/// A time for each record, never stepping back: stamps that are not believed go evenly between those that are.
std::vector<HostTime> times_of(const std::vector<Record>& records) {
  std::vector<HostTime> times(records.size());
  const std::vector<std::size_t> believed = steady(records);
  for (std::size_t k = 0; k < believed.size(); ++k) {
    times[believed[k]] = records[believed[k]].stamp;
    const std::size_t next = k + 1 < believed.size() ? believed[k + 1] : records.size();
    const Duration span = next < records.size() ? records[next].stamp - records[believed[k]].stamp : Duration{};
    const auto steps = static_cast<std::int64_t>(next - believed[k]);
    for (std::size_t i = believed[k] + 1; i < next; ++i) {
      times[i] = times[believed[k]] + span * static_cast<std::int64_t>(i - believed[k]) / steps;
    }
  }
  for (std::size_t i = 0; !believed.empty() && i < believed.front(); ++i) times[i] = records[believed.front()].stamp;
  return times;
}

void keep(const Record& record, HostTime time, CarmenLog& log) {
  const CarmenRecord& content = record.content;
  if (log.wheels.empty() || log.wheels.back().time != time) {
    log.wheels.push_back({time, time, content.x_m, content.y_m, content.yaw_rad});
  }
  if (!content.scan) return;
  log.scans.push_back(*content.scan);
  log.scans.back().time = log.scans.back().arrival = time;
}

template <class Item>
class MemoryStream final : public Stream<Item> {
 public:
  MemoryStream(std::vector<Item> items, std::uint64_t bad_lines) : items_{std::move(items)}, bad_lines_{bad_lines} {}

  const Item* next() override { return at_ < items_.size() ? &items_[at_++] : nullptr; }
  StreamReport report() const override {
    StreamReport report;
    report.items = at_;
    if (bad_lines_ > 0) report.rejections.push_back({"carmen", "bad_lines", bad_lines_});
    return report;
  }
  double progress() const override {
    return items_.empty() ? 1.0 : static_cast<double>(at_) / static_cast<double>(items_.size());
  }

 private:
  std::vector<Item> items_;
  std::uint64_t bad_lines_;
  std::size_t at_ = 0;
};

}  // namespace

bool is_carmen_name(std::string_view path) {
  if (path.ends_with(".gz")) path.remove_suffix(3);
  return path.ends_with(".clf") || path.ends_with(".log");
}

CarmenLog read_carmen_log(const std::string& path) {
  CarmenLog log;
  Lines lines{path};
  if (!lines.is_open()) {
    log.faults.push_back(path + ": cannot be opened");
    return log;
  }
  const std::vector<Record> records = read_records(lines, path, log);
  const std::vector<HostTime> times = times_of(records);
  HostTime last = HostTime::min();
  HostTime last_stamp = HostTime::min();
  for (std::size_t i = 0; i < records.size(); ++i) {
    // A scan and the odometry taken with it have one stamp and stand next to each other: one time.
    const bool same = i > 0 && records[i].stamp == last_stamp && records[i].content.scan && !records[i - 1].content.scan;
    if (!same) last = std::max(times[i], last == HostTime::min() ? times[i] : last + kStampStep);
    last_stamp = records[i].stamp;
    if (last != records[i].stamp && log.recorded_stamps.emplace(last, records[i].stamp).second) ++log.stamps_repaired;
    keep(records[i], last, log);
  }
  if (log.is_empty() && log.faults.empty()) log.faults.push_back(path + ": holds no ODOM, FLASER or ROBOTLASER1 record");
  return log;
}

Sensors sensors_of(CarmenLog log) {
  Sensors sensors;
  sensors.recorded_stamps = std::move(log.recorded_stamps);
  if (!log.wheels.empty()) sensors.wheel = std::make_unique<MemoryStream<WheelOdometry>>(std::move(log.wheels), 0);
  if (!log.scans.empty()) sensors.laser = std::make_unique<MemoryStream<LaserScan>>(std::move(log.scans), log.bad_lines);
  return sensors;
}

}  // namespace slamd::replay
