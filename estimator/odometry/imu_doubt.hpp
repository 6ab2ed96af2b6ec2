#pragma once
// When a scan and the IMU tell two motions: which of the two is believed, and what becomes of the biases. Carries no state
// through time and fuses no scan.

#include "estimator/filter/ieskf.hpp"

namespace slamd {

struct ImuDoubtConfig {
  double most_correction_sigmas = 3.0;  // of the IMU's prior, by which a scan corrects attitude and position
  double gyro_bias_rads = 0.2;          // sigma of the biases once the IMU was wrong
  double accel_bias_mps2 = 1.5;
  double attitude_rad = 0.003;          // and sigma by which the attitude that it left is worse than was thought
  double better_inlier_share = 0.9;     // of the points with a plane, and
  double better_inlier_gain = 1.1;      // so many times the inliers of the IMU's motion: a better motion in any case
  double after_clock_s = 10.0;          // no doubt for so long after a clock was unsure: stamps were wrong rather than values
  double after_gap_s = 1.0;             // nor, where scans fit, after the IMU was silent: those before were fused on a guess
};

/// Whether scan and map agree. most_test_ratio: mean squared normalised residual beyond which they do not.
bool fits(const UpdateSummary& update, double most_test_ratio);

/// Whether nearly all of the scan agrees with the map, and many more points than the `inliers` of another motion.
bool fits_far_better(const ImuDoubtConfig& config, const UpdateSummary& update, std::uint32_t inliers);

/// Whether the scan moved the pose by more than the sigma of the motion on which it was fused.
bool is_moved(const ImuDoubtConfig& config, const UpdateSummary& update);

/// The biases of an IMU that a scan contradicts are unknown, that of the gyro only where the attitude does not fit; and what the
/// filter thought to know of other states by them is not known either. Nor is the attitude that they led to as good as it was
/// thought: what is wrong with it would else pass for a bias.
void doubt_biases(const ImuDoubtConfig& config, const UpdateSummary& contradiction, FilterSnapshot& filter);

}  // namespace slamd
