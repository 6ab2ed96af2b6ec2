#pragma once
// What the data-ready interrupt hands to the main loop. It does not say whether the sensor is read yet.

#include <cstdint>

#include "firmware/core/micros.hpp"

namespace slamd {

struct DataReady {
  std::uint32_t edges = 0;  // since start; wraps
  Micros stamp = 0;         // of the newest edge
};

}  // namespace slamd
