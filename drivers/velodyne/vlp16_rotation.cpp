#include "drivers/velodyne/vlp16_rotation.hpp"

#include <cmath>

#include "drivers/velodyne/vlp16_timing.hpp"

namespace slamd {
namespace {

// Real heads stay within 2 cdeg of their mean step (measured on the recordings of tests/drivers); a quarter of the step
// is left for simulators and speed regulation.
constexpr float kEvenStepCdeg = 10.0F;
constexpr float kEvenStepShare = 0.25F;

double rpm_of_step(double step_cdeg) {
  return step_cdeg / kFullCircleCdeg / to_seconds(kVlp16Block) * 60.0;
}

}  // namespace

float azimuth_difference_cdeg(float a, float b) {
  constexpr auto kCircle = static_cast<float>(kFullCircleCdeg);
  const float d = std::fmod(a - b, kCircle);
  if (d >= kCircle / 2) return d - kCircle;
  return d < -kCircle / 2 ? d + kCircle : d;
}

Vlp16RotationFound find_rotation(const Vlp16Packet& packet, const Vlp16RotationLimits& limits) {
  Vlp16RotationFound found{Vlp16Rejection::kCount, {}};
  Vlp16Rotation& r = found.rotation;
  r.blocks = blocks_in_time(packet.mode);
  const std::size_t stride = kVlp16Blocks / r.blocks;
  for (std::size_t i = 0; i < r.blocks; ++i) r.azimuth_cdeg[i] = packet.azimuth_cdeg[i * stride];

  const std::size_t steps = r.blocks - 1;
  float sum = 0.0F;
  for (std::size_t i = 0; i < steps; ++i) {
    r.step_cdeg[i] = azimuth_difference_cdeg(r.azimuth_cdeg[i + 1], r.azimuth_cdeg[i]);
    sum += r.step_cdeg[i];
  }
  r.mean_step_cdeg = sum / static_cast<float>(steps);
  r.step_cdeg[steps] = r.mean_step_cdeg;
  r.rpm = rpm_of_step(r.mean_step_cdeg);

  const float tolerance = kEvenStepCdeg + kEvenStepShare * std::abs(r.mean_step_cdeg);
  for (std::size_t i = 0; i < steps; ++i) {
    if (std::abs(r.step_cdeg[i] - r.mean_step_cdeg) > tolerance) found.cause = Vlp16Rejection::kAzimuthJump;
  }
  if (found.cause != Vlp16Rejection::kCount) return found;
  if (r.rpm < limits.min_rpm) found.cause = Vlp16Rejection::kStopped;
  if (r.rpm > limits.max_rpm) found.cause = Vlp16Rejection::kTooFast;
  return found;
}

}  // namespace slamd
