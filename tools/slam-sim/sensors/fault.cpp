#include "tools/slam-sim/sensors/fault.hpp"

#include <array>
#include <charconv>
#include <optional>
#include <string_view>

namespace slamd::sim {
namespace {

struct KindRule {
  std::string_view word;
  FaultKind kind;
  bool needs_value;
  std::string_view sensors;  // letters l i g w of those it exists for
};
constexpr std::array<KindRule, 9> kKinds{{{"off", FaultKind::kOff, false, "ligw"},
                                          {"gap", FaultKind::kGap, false, "ligw"},
                                          {"stuck", FaultKind::kStuck, false, "ligw"},
                                          {"loss", FaultKind::kLoss, true, "ligw"},
                                          {"corrupt", FaultKind::kCorrupt, true, "ligw"},
                                          {"late", FaultKind::kLate, true, "ligw"},
                                          {"jump", FaultKind::kJump, true, "g"},
                                          {"clock-jump", FaultKind::kClockJump, true, "liw"},
                                          {"clock-skew", FaultKind::kClockSkew, true, "liw"}}};

std::optional<Channel> sensor_of(std::string_view word) {
  if (word == "lidar") return Channel::kLidar;
  if (word == "imu") return Channel::kImu;
  if (word == "gps") return Channel::kGps;
  if (word == "wheel") return Channel::kWheel;
  return std::nullopt;
}

std::optional<double> number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Cuts `text` at the first `mark`; what follows it, or nothing when the mark is absent.
std::optional<std::string_view> cut(std::string_view& text, char mark) {
  const auto at = text.find(mark);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view rest = text.substr(at + 1);
  text = text.substr(0, at);
  return rest;
}

std::string complain(const std::string& text, std::string_view token, const char* wanted) {
  return "fault \"" + text + "\": \"" + std::string(token) + "\" " + wanted;
}

}  // namespace

const char* const kFaultGrammar =
    "SENSOR:KIND[=VALUE][@START[+DURATION]]   SENSOR: lidar imu gps wheel   times in seconds from the start\n"
    "  off, gap         sends nothing                     stuck            repeats its last measurement\n"
    "  loss=P           loses each packet with chance P   corrupt=P        damages each byte with chance P\n"
    "  late=S           arrives S seconds later           jump=M           gps only: M metres off, claiming a good "
    "fix\n"
    "  clock-jump=MS    not gps: clock set by MS ms        clock-skew=PPM   not gps: clock runs PPM faster\n"
    "  e.g. lidar:loss=0.02  imu:gap@60+2  gps:jump=30@50+20  lidar:clock-jump=250@60";

std::variant<Fault, std::string> parse_fault(const std::string& text) {
  std::string_view head = text;
  Fault fault;
  const auto when = cut(head, '@');
  const auto value = cut(head, '=');
  const auto word = cut(head, ':');
  const auto sensor = sensor_of(head);
  if (!sensor) return complain(text, head, "is no sensor (lidar, imu, gps, wheel)");
  fault.sensor = *sensor;
  const KindRule* rule = nullptr;
  for (const KindRule& candidate : kKinds) {
    if (word && *word == candidate.word) rule = &candidate;
  }
  if (rule == nullptr)
    return complain(text, word.value_or(""),
                    "is no fault (off gap stuck loss corrupt late jump clock-jump clock-skew)");
  if (rule->sensors.find(head.front()) == std::string_view::npos)
    return complain(text, *word, "does not exist for this sensor");
  fault.kind = rule->kind;
  if (rule->needs_value != value.has_value()) {
    return complain(text, *word, rule->needs_value ? "needs a value (=...)" : "takes no value");
  }
  if (value) {
    const auto parsed = number(*value);
    if (!parsed) return complain(text, *value, "is no number");
    const bool probability = rule->kind == FaultKind::kLoss || rule->kind == FaultKind::kCorrupt;
    if (probability && (*parsed < 0.0 || *parsed > 1.0)) return complain(text, *value, "is no probability (0..1)");
    if (rule->kind == FaultKind::kLate && *parsed < 0.0) return complain(text, *value, "is negative");
    fault.value = *parsed;
  }
  if (when) {
    std::string_view start = *when;
    const auto duration = cut(start, '+');
    const auto from = number(start);
    if (!from || *from < 0.0) return complain(text, start, "is no start time (seconds)");
    fault.from_s = *from;
    if (duration) {
      const auto length = number(*duration);
      if (!length || *length < 0.0) return complain(text, *duration, "is no duration (seconds)");
      fault.to_s = *from + *length;
    }
  }
  return fault;
}

}  // namespace slamd::sim
