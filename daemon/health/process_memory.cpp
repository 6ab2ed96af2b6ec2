#include "daemon/health/process_memory.hpp"

#include <fstream>
#include <string>

namespace slamd {

ProcessMemory process_memory() {
  constexpr std::uint64_t kKibibyte = 1024;
  ProcessMemory memory;
  std::ifstream status{"/proc/self/status"};
  std::string line;
  while (std::getline(status, line)) {
    if (line.starts_with("VmRSS:")) memory.resident_bytes = std::strtoull(line.c_str() + 6, nullptr, 10) * kKibibyte;
    if (line.starts_with("VmHWM:")) memory.peak_bytes = std::strtoull(line.c_str() + 6, nullptr, 10) * kKibibyte;
  }
  return memory;
}

}  // namespace slamd
