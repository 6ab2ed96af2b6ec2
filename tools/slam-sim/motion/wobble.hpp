#pragma once
// Filtered noise of a suspension on a road: what roll, pitch and heave do beyond following the ground.

#include <cmath>
#include <numbers>
#include <vector>

#include "tools/slam-sim/world/rng.hpp"

namespace slamd::sim {

/// A damped oscillator shaken by white noise; unit variance in the steady state.
class ShakenSpring {
 public:
  ShakenSpring(double frequency_hz, double damping, double step_s)
      : omega_{2 * std::numbers::pi * frequency_hz}, damping_{damping}, step_{step_s} {}

  double next(Rng& rng) {
    const double push = rng.normal() * std::sqrt(4.0 * damping_ * omega_ * omega_ * omega_ / step_);
    speed_ += step_ * (push - 2.0 * damping_ * omega_ * speed_ - omega_ * omega_ * position_);
    position_ += step_ * speed_;
    return position_;
  }

 private:
  double omega_, damping_, step_;
  double position_ = 0.0, speed_ = 0.0;
};

}  // namespace slamd::sim
