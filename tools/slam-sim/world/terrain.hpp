#pragma once
// Height functions of the ground. Not sampled: HeightField does that.

#include <array>
#include <cmath>
#include <numbers>

#include "tools/slam-sim/world/height_field.hpp"
#include "tools/slam-sim/world/rng.hpp"

namespace slamd::sim {

/// Sum of random waves: rms_m of height, wave lengths between the two bounds (longer waves are higher).
inline HeightField::HeightAt rolling_hills(Rng& rng, double rms_m, double shortest_m, double longest_m) {
  struct Wave {
    double kx, ky, phase, height;
  };
  std::array<Wave, 8> waves;
  double power = 0.0;
  for (Wave& wave : waves) {
    const double length = rng.uniform(shortest_m, longest_m);
    const double heading = rng.uniform(0.0, 2 * std::numbers::pi);
    const double k = 2 * std::numbers::pi / length;
    wave = {k * std::cos(heading), k * std::sin(heading), rng.uniform(0.0, 2 * std::numbers::pi), length};
    power += 0.5 * length * length;
  }
  const double scale = rms_m / std::sqrt(power);
  return [waves, scale](double x, double y) {
    double z = 0.0;
    for (const Wave& wave : waves) z += scale * wave.height * std::sin(wave.kx * x + wave.ky * y + wave.phase);
    return z;
  };
}

}  // namespace slamd::sim
