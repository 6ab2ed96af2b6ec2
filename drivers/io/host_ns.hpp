#pragma once
// Which numbers of a file can be host times. Reads no file.

#include <cstdint>

namespace slamd {

/// Until the year 2255, so that sums and differences of such times stay within 64 bits.
inline constexpr std::int64_t kMostHostNs = 9'000'000'000'000'000'000;

constexpr bool is_host_ns(std::int64_t ns) { return ns >= 0 && ns <= kMostHostNs; }

}  // namespace slamd
