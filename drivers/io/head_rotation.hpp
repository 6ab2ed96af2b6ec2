#pragma once
// How the head of a spinning LiDAR turns inside one packet: the azimuth step of each column of firings, and whether it is
// believable. Knows no packet, time stamp or point.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "estimator/types/time.hpp"

namespace slamd {

constexpr int kFullCircleCdeg = 36000;

struct RotationLimits {
  double min_rpm = 270.0;  // sensors do 300 to 1200; 10 % is left for their regulation
  double max_rpm = 1320.0;
};

enum class RotationFault : std::uint8_t {
  kNone,
  kUneven,   // steps far from their mean
  kTooSlow,  // or standing
  kTooFast
};

/// Azimuths and steps of the columns of one packet, in hundredths of a degree.
struct HeadRotation {
  static constexpr std::size_t kMaxColumns = 12;

  std::size_t columns = 0;
  std::array<std::uint16_t, kMaxColumns> azimuth_cdeg{};  // of each column's first firing
  std::array<float, kMaxColumns> step_cdeg{};             // from it to the next column's first firing
  float mean_step_cdeg = 0.0F;
  double rpm = 0.0;
};

struct RotationFound {
  RotationFault fault = RotationFault::kNone;
  HeadRotation rotation;
};

/// azimuths_cdeg  of each column's first firing, 2 to kMaxColumns of them, 0..35999
/// period         from one column to the next
/// Steps are taken across the 35999/0 seam. The last column has no successor in the packet; it gets the packet's mean step,
/// whose error (readings jitter by 0.02 degrees) is a fraction of the last step's. Pure.
RotationFound find_rotation(std::span<const std::uint16_t> azimuths_cdeg, Duration period, const RotationLimits& limits);

/// Difference a - b of two azimuths on the circle, -18000 <= d < 18000 hundredths of a degree.
float azimuth_difference_cdeg(float a, float b);

}  // namespace slamd
