#include "daemon/inject/fault_switch.hpp"

namespace slamd {

const char* name(FaultVerb verb) {
  switch (verb) {
    case FaultVerb::kNone: return "none";
    case FaultVerb::kOff: return "off";
    case FaultVerb::kStuck: return "stuck";
    case FaultVerb::kGarbage: return "garbage";
    case FaultVerb::kWrong: return "wrong";
    case FaultVerb::kSlow: return "slow";
    case FaultVerb::kDelayed: return "delayed";
    case FaultVerb::kIntermittent: return "intermittent";
  }
  return "unknown";
}

std::optional<FaultVerb> fault_verb(std::string_view wanted) {
  for (const FaultVerb verb : kFaultVerbs) {
    if (wanted == name(verb)) return verb;
  }
  return std::nullopt;
}

}  // namespace slamd
