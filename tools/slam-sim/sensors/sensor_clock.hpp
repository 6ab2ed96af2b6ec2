#pragma once
// A sensor's own counter against true time: start value, skew, and the faults of clocks (steps, further skew).

#include <algorithm>
#include <vector>

namespace slamd::sim {

class SensorClock {
 public:
  SensorClock(double start_s, double skew_ppm) : start_s_{start_s}, rate_{1.0 + skew_ppm * 1e-6} {}

  void step_at(double t, double step_s) { steps_.push_back({t, 1e300, step_s, 0.0}); }
  void drift_between(double from, double to, double ppm) { steps_.push_back({from, to, 0.0, ppm * 1e-6}); }

  /// What the counter shows at true time t (seconds from the start of the drive), in seconds; not wrapped.
  double reading(double t) const {
    double shown = start_s_ + t * rate_;
    for (const Disturbance& d : steps_) {
      if (t >= d.from) shown += d.step_s + d.drift * (std::min(t, d.to) - d.from);
    }
    return shown;
  }
  double rate() const { return rate_; }

 private:
  struct Disturbance {
    double from, to, step_s, drift;
  };
  double start_s_, rate_;
  std::vector<Disturbance> steps_;
};

}  // namespace slamd::sim
