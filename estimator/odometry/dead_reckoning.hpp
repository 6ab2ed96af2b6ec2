#pragma once
// Carries the filter through time over IMU samples, and over their gaps by a constant-velocity model. No LiDAR here.

#include "estimator/filter/imu_propagation.hpp"
#include "estimator/odometry/imu_buffer.hpp"

namespace slamd {

struct DeadReckoningConfig {
  ImuNoise imu_noise;
  double imu_gap_s = 0.025;            // more between two samples: the constant-velocity model fills in
  double coast_accel_mps2_rthz = 2.0;  // constant-velocity model: white acceleration
  double coast_gyro_rads_rthz = 0.5;   // and white angular acceleration's effect on attitude
  double clipped_accel_mps2_rthz = 1.0;   // while a sample is clipped
  double clipped_gyro_rads_rthz = 0.2;
};

/// What the stretch of time just covered was made of.
struct DeadReckoningSummary {
  double measured_s = 0.0;
  double coasted_s = 0.0;
  bool clipped = false;

  DeadReckoningSummary operator+(const DeadReckoningSummary& next) const {
    return {measured_s + next.measured_s, coasted_s + next.coasted_s, clipped || next.clipped};
  }
};

class DeadReckoning {
 public:
  explicit DeadReckoning(const DeadReckoningConfig& config) : config_{config} {}

  /// Moves `filter` to `to`, calling on_knot(filter) after every piece. Work is bounded by the samples in between.
  template <class OnKnot>
  DeadReckoningSummary advance(const ImuBuffer& samples, HostTime to, FilterSnapshot& filter, OnKnot&& on_knot) const {
    DeadReckoningSummary summary;
    walk(samples, filter.time, to, from_seconds(config_.imu_gap_s), [&](const ImuPiece& piece) {
      step(piece, filter, summary);
      on_knot(static_cast<const FilterSnapshot&>(filter));
    });
    return summary;
  }

  /// Likewise, as if nothing had been measured.
  template <class OnKnot>
  DeadReckoningSummary coast(HostTime to, FilterSnapshot& filter, OnKnot&& on_knot) const {
    constexpr Duration kStep = std::chrono::milliseconds{10};
    DeadReckoningSummary summary;
    while (filter.time < to) {
      step({.from = filter.time, .to = std::min(to, filter.time + kStep)}, filter, summary);
      on_knot(static_cast<const FilterSnapshot&>(filter));
    }
    return summary;
  }

 private:
  void step(const ImuPiece& piece, FilterSnapshot& filter, DeadReckoningSummary& summary) const;

  DeadReckoningConfig config_;
};

}  // namespace slamd
