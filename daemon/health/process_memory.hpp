#pragma once
// How much memory this process takes, as the kernel counts it. Reads /proc: not for real-time threads.

#include <cstdint>

namespace slamd {

struct ProcessMemory {
  std::uint64_t resident_bytes = 0;
  std::uint64_t peak_bytes = 0;
};

/// Zeros where /proc is not mounted.
ProcessMemory process_memory();

}  // namespace slamd
