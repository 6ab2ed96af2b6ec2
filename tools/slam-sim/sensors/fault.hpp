#pragma once
// What can go wrong with a sensor, as a value and as text. Doing it is fault_injector's and the sensors' own.

#include <string>
#include <variant>
#include <vector>

#include "tools/slam-sim/sensors/wire_event.hpp"

namespace slamd::sim {

enum class FaultKind : std::uint8_t { kOff, kGap, kStuck, kLoss, kCorrupt, kLate, kJump, kClockJump, kClockSkew };

/// value: probability (loss, corrupt), seconds (late), metres (jump), milliseconds (clock-jump), ppm (clock-skew)
struct Fault {
  Channel sensor = Channel::kLidar;
  FaultKind kind = FaultKind::kOff;
  double value = 0.0;
  double from_s = 0.0;
  double to_s = 1e300;

  bool active(double t) const { return t >= from_s && t < to_s; }
};

/// The grammar, for --help.
extern const char* const kFaultGrammar;

/// SENSOR:KIND[=VALUE][@START[+DURATION]]. On failure a sentence that names the bad token.
std::variant<Fault, std::string> parse_fault(const std::string& text);

}  // namespace slamd::sim
