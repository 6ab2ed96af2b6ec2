#pragma once
// How the VLP-16's mirror-less head turns inside one packet: the azimuth step of each block, and whether it is
// believable. Knows nothing of time stamps or points.

#include <array>
#include <cstddef>
#include <cstdint>

#include "drivers/velodyne/vlp16_packet.hpp"

namespace slamd {

struct Vlp16RotationLimits {
  double min_rpm = 270.0;  // the sensor does 300 to 1200; 10 % is left for its regulation
  double max_rpm = 1320.0;
};

/// Azimuths and steps of the blocks that differ in time (12, dual return 6), in hundredths of a degree.
struct Vlp16Rotation {
  std::size_t blocks = 0;
  std::array<std::uint16_t, kVlp16Blocks> azimuth_cdeg{};  // of each block's first firing
  std::array<float, kVlp16Blocks> step_cdeg{};             // from it to the next block's first firing
  float mean_step_cdeg = 0.0F;
  double rpm = 0.0;
};

struct Vlp16RotationFound {
  Vlp16Rejection cause;  // kCount when believable
  Vlp16Rotation rotation;
};

/// Steps are taken across the 35999/0 seam. The last block has no successor in the packet; it gets the packet's mean
/// step, whose error (readings jitter by 0.02 degrees) is an eleventh of the last step's. Refuses kStopped, kTooFast,
/// and steps far from the mean (kAzimuthJump). Pure.
Vlp16RotationFound find_rotation(const Vlp16Packet& packet, const Vlp16RotationLimits& limits);

/// Difference a - b of two azimuths on the circle, -18000 <= d < 18000 hundredths of a degree.
float azimuth_difference_cdeg(float a, float b);

}  // namespace slamd
