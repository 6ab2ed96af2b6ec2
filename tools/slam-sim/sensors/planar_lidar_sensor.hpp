#pragma once
// A 2D LiDAR of the LDS-01 kind in a world: finished scans as lines of a drive folder's scan.csv. No wire bytes: slamd has no
// driver for this sensor. Source: TurtleBot3 e-manual, appendix LDS-01 (360 beams, 300 /min, 0.12 to 3.5 m, +-10 mm).

#include <optional>

#include "tools/slam-sim/sensors/lidar_model.hpp"

namespace slamd::sim {

struct PlanarLidarModel {
  int beams = 360;
  double rate_hz = 5.0;
  double min_range_m = 0.12, max_range_m = 3.5;
  double range_noise_m = 0.01;  // standard deviation
  double latency_min_s = 0.0005;
  double latency_jitter_s = 0.0015;  // uniform, on top
};

class PlanarLidarSensor {
 public:
  PlanarLidarSensor(const PlanarLidarModel& model, const Surroundings& around, std::uint64_t seed)
      : model_{model}, around_{around}, seed_{seed} {}

  /// The next scan that is complete before `until` (seconds); counter-clockwise from the LiDAR's x axis, every beam cast from the
  /// sensor's pose at its own time. The bytes are a line of scan.csv behind its t_ns.
  std::optional<WireEvent> next(double until);

 private:
  double range_of(int beam, double t, const std::vector<MovingBody>& movers, double movers_time, Rng& rng) const;

  PlanarLidarModel model_;
  Surroundings around_;
  std::uint64_t seed_;
  std::int64_t count_ = 0;
};

}  // namespace slamd::sim
