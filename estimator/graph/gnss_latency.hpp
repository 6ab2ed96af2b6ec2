#pragma once
// How much older than its stamp a fix really is, from innovations of position and velocity along the way driven. No fix is
// judged here.

#include <Eigen/Core>
#include <cmath>

namespace slamd {

struct GnssLatency {
  double correction_s = 0.0;  // the fix is so much older than its stamp says
  double sigma_s = 1.0e3;

  bool significant() const { return std::abs(correction_s) > 3.0 * sigma_s && std::abs(correction_s) > 0.02; }
};

/// A fix that is older by c has a position that lacks c * velocity and a velocity that lacks c * acceleration. What is
/// constant in the innovations is the alignment's fault and says nothing.
class GnssLatencyEstimator {
 public:
  /// innovation_m  measured less predicted antenna position; velocity at the fix in the same frame, m/s
  /// weight        1 / variance of what is independent in it, 1/m^2
  void add_position(const Eigen::Vector2d& innovation_m, const Eigen::Vector2d& velocity_mps, double weight) {
    position_.add(innovation_m, velocity_mps, weight);
  }
  /// Likewise with velocity (m/s) and acceleration (m/s^2); weight in s^2/m^2. The receiver's velocity is taken to be of
  /// the same instant as its position.
  void add_velocity(const Eigen::Vector2d& innovation_mps, const Eigen::Vector2d& acceleration_mps2, double weight) {
    velocity_.add(innovation_mps, acceleration_mps2, weight);
  }

  /// Least squares of innovation = constant - correction * rate.
  GnssLatency estimate() const {
    const double information = position_.information() + velocity_.information();
    if (information <= 0.0) return {};
    return {-(position_.along() + velocity_.along()) / information, 1.0 / std::sqrt(information)};
  }

  /// So much older than their stamps the fixes are taken to be that innovations are made of, seconds.
  double believed_s() const { return believed_s_; }
  /// From now on innovations are those of fixes taken to be older by so much; so are those added before.
  void shift(double correction_s) {
    believed_s_ += correction_s;
    position_.shift(correction_s);
    velocity_.shift(correction_s);
  }

 private:
  /// Sums, weighted.
  struct Regression {
    double weight = 0.0;
    Eigen::Vector2d innovation = Eigen::Vector2d::Zero();
    Eigen::Vector2d rate = Eigen::Vector2d::Zero();
    double product = 0.0;
    double squares = 0.0;

    void add(const Eigen::Vector2d& i, const Eigen::Vector2d& r, double w) {
      weight += w;
      innovation += w * i;
      rate += w * r;
      product += w * i.dot(r);
      squares += w * r.squaredNorm();
    }
    double along() const { return weight > 0.0 ? product - innovation.dot(rate) / weight : 0.0; }
    double information() const { return weight > 0.0 ? squares - rate.squaredNorm() / weight : 0.0; }
    void shift(double correction_s) {
      innovation += correction_s * rate;
      product += correction_s * squares;
    }
  };

  Regression position_, velocity_;
  double believed_s_ = 0.0;
};

}  // namespace slamd
