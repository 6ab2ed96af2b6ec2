#include "drivers/io/head_rotation.hpp"

#include <algorithm>
#include <cmath>

namespace slamd {
namespace {

// Real heads stay within 2 cdeg of their mean step (measured on the recordings of tests/drivers); a quarter of the step
// is left for simulators and speed regulation.
constexpr float kEvenStepCdeg = 10.0F;
constexpr float kEvenStepShare = 0.25F;

}  // namespace

float azimuth_difference_cdeg(float a, float b) {
  constexpr auto kCircle = static_cast<float>(kFullCircleCdeg);
  const float d = std::fmod(a - b, kCircle);
  if (d >= kCircle / 2) return d - kCircle;
  return d < -kCircle / 2 ? d + kCircle : d;
}

RotationFound find_rotation(std::span<const std::uint16_t> azimuths_cdeg, Duration period, const RotationLimits& limits) {
  RotationFound found;
  HeadRotation& r = found.rotation;
  r.columns = azimuths_cdeg.size();
  std::copy(azimuths_cdeg.begin(), azimuths_cdeg.end(), r.azimuth_cdeg.begin());

  const std::size_t steps = r.columns - 1;
  float sum = 0.0F;
  for (std::size_t i = 0; i < steps; ++i) {
    r.step_cdeg[i] = azimuth_difference_cdeg(r.azimuth_cdeg[i + 1], r.azimuth_cdeg[i]);
    sum += r.step_cdeg[i];
  }
  r.mean_step_cdeg = sum / static_cast<float>(steps);
  r.step_cdeg[steps] = r.mean_step_cdeg;
  r.rpm = static_cast<double>(r.mean_step_cdeg) / kFullCircleCdeg / to_seconds(period) * 60.0;

  const float tolerance = kEvenStepCdeg + kEvenStepShare * std::abs(r.mean_step_cdeg);
  for (std::size_t i = 0; i < steps; ++i) {
    if (std::abs(r.step_cdeg[i] - r.mean_step_cdeg) > tolerance) found.fault = RotationFault::kUneven;
  }
  if (found.fault != RotationFault::kNone) return found;
  if (r.rpm < limits.min_rpm) found.fault = RotationFault::kTooSlow;
  if (r.rpm > limits.max_rpm) found.fault = RotationFault::kTooFast;
  return found;
}

}  // namespace slamd
