#pragma once
// The files that a replay writes while it runs: odom.tum, imu_rate.tum, covariance.csv, keyframes.csv. The map comes at the end.

#include <fstream>
#include <string>

#include "estimator/types/keyframe.hpp"

namespace slamd::replay {

/// "time_s x y z qx qy qz qw" a line, time with nine decimals, the rest so that reading gives the same bits.
void write_tum(std::ostream& out, HostTime time, const Pose& T_odom_base);

class Output {
 public:
  /// Makes the folder. is_good() is false when a file cannot be written.
  explicit Output(const std::string& folder);

  /// One pose a scan, and its covariance (upper triangle, rows as NavState::covariance).
  void scan(const NavState& state);
  void imu_rate(const NavState& state);
  /// Time, up_base, up_sigma_rad and the upper triangle of relative_covariance.
  void keyframe(const Keyframe& keyframe);
  /// Flushes; false when anything could not be written (disk full).
  bool finish();

  std::string path(const char* name) const { return folder_ + "/" + name; }

 private:
  std::string folder_;
  std::ofstream odom_, imu_rate_, covariance_, keyframes_;
};

}  // namespace slamd::replay
