#pragma once
// Band-limited noise of a suspension on a road: what roll, pitch and heave do beyond following the ground.

#include <array>
#include <cmath>
#include <numbers>

#include "tools/slam-sim/world/rng.hpp"

namespace slamd::sim {

/// A sum of waves with random phases: unit variance, nothing outside the band, smooth for ever.
class BandNoise {
 public:
  BandNoise(double low_hz, double high_hz, Rng& rng) {
    for (std::size_t i = 0; i < waves_.size(); ++i) {
      const double share = (static_cast<double>(i) + rng.uniform()) / static_cast<double>(waves_.size());
      waves_[i] = {2 * std::numbers::pi * low_hz * std::pow(high_hz / low_hz, share),
                   rng.uniform(0.0, 2 * std::numbers::pi)};
    }
  }

  double at(double t) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) sum += std::sin(wave.omega * t + wave.phase);
    return sum * std::sqrt(2.0 / static_cast<double>(waves_.size()));
  }

 private:
  struct Wave {
    double omega, phase;
  };
  std::array<Wave, 24> waves_{};
};

}  // namespace slamd::sim
