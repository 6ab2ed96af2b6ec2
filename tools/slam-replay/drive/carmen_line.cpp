#include "tools/slam-replay/drive/carmen_line.hpp"

#include <charconv>
#include <cmath>

namespace slamd::replay {
namespace {

constexpr float kFlaserRangeMax_m = 80.0F;  // FLASER does not tell it; SICK's code for no return is 81.83
constexpr double kMostTime_s = 8e9;

/// The words of a line, one after the other. After the first word that is no number where one is asked for, ok() is false.
class Words {
 public:
  explicit Words(std::string_view line) : rest_{line} {}

  std::string_view word() {
    while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\t' || rest_.front() == '\r')) rest_.remove_prefix(1);
    const std::string_view found = rest_.substr(0, rest_.find_first_of(" \t\r"));
    rest_.remove_prefix(found.size());
    return found;
  }
  double number() {
    const std::string_view text = word();
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) ok_ = false;
    return value;
  }
  void skip_numbers(std::size_t count) {
    for (std::size_t i = 0; i < count && ok_; ++i) number();
  }
  bool ok() const { return ok_; }

 private:
  std::string_view rest_;
  bool ok_ = true;
};

CarmenLine fault(const char* reason) { return {.record = {}, .laser_forward_m = {}, .reason = reason}; }

/// Robot pose, stamp: what ends every record. `skipped` numbers stand between the two.
CarmenLine finish(Words& words, CarmenRecord record, std::size_t skipped) {
  record.x_m = words.number();
  record.y_m = words.number();
  record.yaw_rad = words.number();
  words.skip_numbers(skipped);
  record.time_s = words.number();
  if (!words.ok()) return fault("a number is missing or is none");
  if (!(record.time_s >= 0.0 && record.time_s < kMostTime_s)) return fault("the stamp is no time");
  if (std::abs(record.x_m) > 1e7 || std::abs(record.y_m) > 1e7) return fault("the odometry is off the earth");
  return {.record = std::move(record), .laser_forward_m = {}, .reason = nullptr};
}

bool read_beams(Words& words, double begin_rad, double step_rad, std::size_t count, LaserScan& scan) {
  scan.beams.reserve(count);
  for (std::size_t i = 0; i < count && words.ok(); ++i) {
    const auto range = static_cast<float>(words.number());
    const bool returned = range > 0.0F && range < scan.range_max_m;
    scan.beams.push_back({static_cast<float>(begin_rad + static_cast<double>(i) * step_rad), returned ? range : 0.0F, 0.0F});
  }
  return words.ok();
}

/// FLASER n ranges laser-pose robot-pose stamp host logger-stamp; half a turn from right to left.
CarmenLine parse_flaser(Words& words) {
  const double count = words.number();
  if (!words.ok() || !(count >= 1.0 && count <= static_cast<double>(kMostCarmenBeams))) return fault("not so many beams");
  const auto beams = static_cast<std::size_t>(count);
  const double step_rad = M_PI / static_cast<double>(beams % 2 == 0 ? beams : beams - (beams > 1 ? 1 : 0));
  CarmenRecord record;
  record.scan.emplace().range_max_m = kFlaserRangeMax_m;
  if (!read_beams(words, -0.5 * M_PI, step_rad, beams, *record.scan)) return fault("a range is missing or is no number");
  words.skip_numbers(3);
  return finish(words, std::move(record), 0);
}

/// ROBOTLASER1 type begin field step range-max accuracy remission-mode n ranges m remissions laser-pose robot-pose tv rv safety stamp
CarmenLine parse_robotlaser(Words& words) {
  words.skip_numbers(1);
  const double begin_rad = words.number();
  words.skip_numbers(1);
  const double step_rad = words.number();
  CarmenRecord record;
  record.scan.emplace().range_max_m = static_cast<float>(words.number());
  words.skip_numbers(2);
  const double count = words.number();
  if (!words.ok() || !(count >= 1.0 && count <= static_cast<double>(kMostCarmenBeams))) return fault("not so many beams");
  if (!read_beams(words, begin_rad, step_rad, static_cast<std::size_t>(count), *record.scan)) {
    return fault("a range is missing or is no number");
  }
  const double remissions = words.number();
  if (!words.ok() || !(remissions >= 0.0 && remissions <= static_cast<double>(kMostCarmenBeams))) return fault("not so many remissions");
  words.skip_numbers(static_cast<std::size_t>(remissions) + 3);
  return finish(words, std::move(record), 5);
}

}  // namespace

CarmenLine parse_carmen_line(std::string_view line) {
  Words words{line};
  const std::string_view kind = words.word();
  if (kind == "ODOM") return finish(words, {}, 3);
  if (kind == "FLASER") return parse_flaser(words);
  if (kind == "ROBOTLASER1") return parse_robotlaser(words);
  if (kind != "PARAM" || words.word() != "robot_frontlaser_offset") return {};
  const double forward_m = words.number();
  if (!words.ok() || std::abs(forward_m) > 100.0) return fault("the laser's offset is no length");
  return {.record = {}, .laser_forward_m = forward_m, .reason = nullptr};
}

}  // namespace slamd::replay
