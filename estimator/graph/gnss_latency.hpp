#pragma once
// How much older than its stamp a fix really is, from innovations along the way driven. No fix is judged here.

#include <Eigen/Core>
#include <cmath>

namespace slamd {

struct GnssLatency {
  double correction_s = 0.0;  // the fix is so much older than its stamp says
  double sigma_s = 1.0e3;

  bool significant() const { return std::abs(correction_s) > 3.0 * sigma_s && std::abs(correction_s) > 0.02; }
};

class GnssLatencyEstimator {
 public:
  /// independent_share  of the fixes: errors that last for many fixes count once
  explicit GnssLatencyEstimator(double independent_share) : independent_share_{independent_share} {}

  /// innovation_m  measured less predicted antenna position; velocity at the fix in the same frame, m/s
  void add(const Eigen::Vector2d& innovation_m, const Eigen::Vector2d& velocity_mps, double sigma_m) {
    const double weight = 1.0 / (sigma_m * sigma_m);
    along_ += weight * innovation_m.dot(velocity_mps);
    squares_ += weight * velocity_mps.squaredNorm();
  }
  /// Least squares of innovation = -correction * velocity.
  GnssLatency estimate() const {
    if (squares_ <= 0.0) return {};
    return {-along_ / squares_, 1.0 / std::sqrt(squares_ * independent_share_)};
  }
  void clear() { along_ = squares_ = 0.0; }

 private:
  double independent_share_;
  double along_ = 0.0;
  double squares_ = 0.0;
};

}  // namespace slamd
