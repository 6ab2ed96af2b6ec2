#pragma once
// One scan onto the filter, on the motion that explains it: the IMU's, that of an IMU whose biases are unknown, or a constant
// velocity. Inserts nothing into the map and judges no status.

#include "estimator/odometry/dead_reckoning.hpp"
#include "estimator/odometry/imu_doubt.hpp"
#include "estimator/odometry/scan_fusion.hpp"

namespace slamd {

struct ScanMatcherConfig {
  DeadReckoningConfig dead_reckoning;
  ImuDoubtConfig imu_doubt;
  std::uint32_t min_inliers = 0;  // that a scan needs to contradict anybody
  double max_test_ratio = 0.0;    // mean squared normalised residual beyond which scan and map do not fit
};

struct ScanMatch {
  UpdateSummary update;
  DeadReckoningSummary carried;    // how the filter came to the scan's end
  bool imu_contradicted = false;   // not by what the IMU said
};

class ScanMatcher {
 public:
  explicit ScanMatcher(const ScanMatcherConfig& config) : config_{config}, dead_reckoning_{config.dead_reckoning} {}

  /// The filter moves to the scan's end and takes the scan in. Scans stamped wrong contradict the best of IMUs: clock_unsure.
  ScanMatch match(const Scan& scan, const ImuBuffer& samples, bool clock_unsure, ScanFusion& fusion, FilterSnapshot& filter);

  /// No scan: the filter moves on to `to`.
  DeadReckoningSummary pass(const ImuBuffer& samples, HostTime to, FilterSnapshot& filter) const {
    return dead_reckoning_.advance(samples, to, filter, [](const FilterSnapshot&) {});
  }

  /// Hears of every stage from now on; must outlive the matcher. Null: nobody.
  void set_stage_listener(StageListener* listener) { listener_ = listener; }

 private:
  struct Input {
    const Scan& scan;
    const ImuBuffer& samples;
  };
  ScanMatch explain(const UpdateSummary& contradiction, const FilterSnapshot& before, const Input& input, ScanFusion& fusion,
                    FilterSnapshot& filter) const;
  /// samples  null: nothing is taken for measured, the velocity for constant
  ScanMatch match_by(const ImuBuffer* samples, const Scan& scan, ScanFusion& fusion, FilterSnapshot& filter) const;
  DeadReckoningSummary carry_by(const ImuBuffer* samples, const Scan& scan, ScanMotion& motion, FilterSnapshot& filter) const;
  bool is_contradiction(HostTime at, const ScanMatch& match) const;
  bool is_explained(const UpdateSummary& update) const;
  void learn_rate(const FilterSnapshot& before, const ScanMatch& match, FilterSnapshot& filter);

  ScanMatcherConfig config_;
  DeadReckoning dead_reckoning_;
  Eigen::Vector3d turn_rads_ = Eigen::Vector3d::Zero();  // imu frame, mean over the newest scan that was fused
  HostTime imu_believed_until_{};    // whatever scans tell,
  HostTime guess_forgiven_until_{};  // and only if they fit
  StageListener* listener_ = nullptr;
};

}  // namespace slamd
