#pragma once
// Which way is up, in base, from gyro and accelerometer: gravity in the long run, the gyro meanwhile. No heading, no position.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "estimator/types/imu_sample.hpp"

namespace slamd {

struct TiltConfig {
  double rest_s = 0.5;             // of samples whose mean is the first direction
  double correction_s = 8.0;       // time constant by which the accelerometer corrects the gyro
  double most_force_error_mps2 = 2.0;  // a specific force that differs more from gravity says nothing
};

class Tilt {
 public:
  Tilt(const Eigen::Quaterniond& R_base_imu, const TiltConfig& config) : R_base_imu_{R_base_imu}, config_{config} {}

  /// speed_mps  of base forwards, as far as known: what a turn adds to the specific force is taken off
  void add(const ImuSample& sample, double speed_mps);

  bool is_known() const { return count_s_ >= config_.rest_s; }
  /// Unit, against gravity, base frame; straight up while nothing is known.
  const Eigen::Vector3d& up_base() const { return up_; }
  /// About the vertical, rad/s, bias of the start included.
  double yaw_rate() const { return yaw_rate_; }

 private:
  Eigen::Quaterniond R_base_imu_;
  TiltConfig config_;
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d force_sum_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d bias_rads_ = Eigen::Vector3d::Zero();  // of roll and pitch rate
  HostTime last_{};
  double count_s_ = 0.0;
  double yaw_rate_ = 0.0;
};

}  // namespace slamd
