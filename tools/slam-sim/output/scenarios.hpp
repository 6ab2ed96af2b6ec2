#pragma once
// Named drives: sensible presets of world, course and disturbances, which options may then change.

#include <string>
#include <vector>

#include "tools/slam-sim/sensors/simulation.hpp"

namespace slamd::sim {

struct Scenario {
  const char* name;
  const char* meaning;
  void (*apply)(DriveSpec&);
};

const std::vector<Scenario>& scenarios();

/// Null when there is none of that name.
const Scenario* find_scenario(const std::string& name);

}  // namespace slamd::sim
