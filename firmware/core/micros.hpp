#pragma once
// The firmware's one clock: microseconds since start, 64 bits. Host time does not exist here.

#include <cstdint>

namespace slamd {

using Micros = std::uint64_t;

}  // namespace slamd
