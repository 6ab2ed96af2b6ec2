#pragma once
// Where the vehicle should be by now, from the newest estimate: wheels for the way and the gyro for the turn, each as far as
// there, else the velocity goes on. It sees no scan; who matched one tells it the result.

#include <deque>
#include <optional>

#include "estimator/grid/line_matcher.hpp"
#include "estimator/grid/planar_motion.hpp"
#include "estimator/types/time.hpp"
#include "estimator/types/wheel_odometry.hpp"

namespace slamd {

struct MotionPriorConfig {
  double start_mps = 4.0;             // that the vehicle may have at first, without wheels
  double accel_mps2 = 2.0;            // by which the velocity may change, without wheels
  double turn_accel_rads2 = 2.0;      // likewise the turn rate, without gyro and wheels
  double wheel_slip = 0.1;            // of the way that the wheels tell
  double wheel_turn_slip = 0.15;      // of the turn that they tell
  double wheel_turn_rad_m = 0.1;     // turn that they do not tell, a metre: a bias, which a map would take over if it were believed
  double gyro_rads = 0.005;           // beyond its bias
  double least_sigma_m = 0.005;       // of any prior
  double least_sigma_rad = 0.005;
  double gyro_least_sigma_rad = 0.0005;  // likewise where the gyro tells the turn
};

class MotionPrior {
 public:
  explicit MotionPrior(const MotionPriorConfig& config) : config_{config} {}

  void add(const WheelOdometry& wheels);
  /// yaw_rate  about the vertical, rad/s, bias included
  void add_turn(HostTime time, double yaw_rate_rads);

  struct Prediction {
    PlanarMotion motion;      // T_odom_base from begin to end, its seconds count from end
    PlanarPrior prior;        // at end
    double from_s = 0.0;      // time since the newest estimate
  };
  /// begin <= end; at least one estimate() before.
  Prediction predict(HostTime begin, HostTime end) const;

  /// A scan told where the vehicle is; covariance by right perturbation. is_measured: false = it told nothing, and this is the
  /// prediction again; velocity and bias then stay.
  void estimate(HostTime time, const PlanarPose& T_odom_base, const Eigen::Matrix3d& covariance, bool is_measured);

  bool has_estimate() const { return time_ != HostTime{}; }
  /// Whether scans (kVelocityScans of them that fitted) or wheels have told how fast the vehicle is.
  bool knows_velocity() const { return measured_ >= kVelocityScans || wheels_at(time_).has_value(); }
  HostTime time() const { return time_; }
  const PlanarPose& pose() const { return T_odom_base_; }
  /// Of base in base: x, y (m/s), yaw (rad/s).
  const Eigen::Vector3d& velocity() const { return velocity_; }

 private:
  static constexpr int kVelocityScans = 3;
  struct Turn {
    HostTime time;
    double yaw_rad, rate_rads;  // turned since the first sample
  };
  std::optional<double> turned(HostTime time) const;
  std::optional<PlanarPose> wheels_at(HostTime time) const;
  PlanarPose relative(HostTime time) const;
  Eigen::Matrix3d noise(HostTime end, const PlanarPose& way) const;
  void learn_bias(HostTime time, const PlanarPose& T_odom_base);

  MotionPriorConfig config_;
  std::deque<WheelOdometry> wheels_;
  std::deque<Turn> turns_;
  HostTime time_{};
  PlanarPose T_odom_base_;
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  int measured_ = 0;  // velocities, up to kVelocityScans
  double bias_rads_ = 0.0, bias_sigma_rads_ = 0.02;
};

}  // namespace slamd
