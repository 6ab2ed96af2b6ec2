#pragma once
// The ten bytes of a RoboSense time stamp to device time, in both forms that the sensors send. No mapping to host time.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "estimator/types/time.hpp"

namespace slamd {

constexpr std::size_t kRobosenseStampBytes = 10;

/// Seconds since 1970 (six bytes) and microseconds (four), both big-endian: what an Airy sends; or a calendar: year since 2000,
/// month, day, hour, minute, second (a byte each), milliseconds and microseconds (two each), as older firmware of the family. A
/// count of seconds begins with a zero until the year 34,000, a calendar with its year. Nothing for what is no time. Pure.
std::optional<DeviceTime> read_robosense_stamp(std::span<const std::uint8_t, kRobosenseStampBytes> bytes);

}  // namespace slamd
