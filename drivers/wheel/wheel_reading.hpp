#pragma once
// One line of the wheels' serial protocol: text to a checked reading and back. It knows no time but the device's counter.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "estimator/types/time.hpp"

namespace slamd {

/// The counter of microseconds is of 32 bits.
constexpr Duration kWheelCounterPeriod{(std::int64_t{1} << 32U) * 1'000};
constexpr double kWheelMostMetres = 1e7;   // beyond, on either axis: no vehicle's odometry
constexpr double kWheelMostRadians = 1e6;

/// As the device says it: the pose of base since its counter began.
struct WheelReading {
  std::uint32_t device_us = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

/// Whether all numbers are finite and within the limits above.
bool is_possible(const WheelReading& reading);

/// Whether the text of a line names this protocol's sentence; of another one nothing else is asked.
bool is_wheel_sentence(std::string_view text);
/// "WODO,<device_us>,<x_m>,<y_m>,<yaw_rad>", without '$' and checksum. Nothing unless all four fields are whole numbers of
/// their kind and possible; further fields are refused too.
std::optional<WheelReading> parse_wheel_text(std::string_view text);
/// The whole line with checksum and line end, to the tenth of a millimetre and the microradian.
std::string wheel_line(const WheelReading& reading);

}  // namespace slamd
