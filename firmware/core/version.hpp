#pragma once
// The firmware's own version; it changes with the firmware, not with slamd's.

#include <array>
#include <cstdint>

namespace slamd {

constexpr std::array<std::uint8_t, 3> kFirmwareVersion{0, 1, 0};  // major, minor, patch

}  // namespace slamd
