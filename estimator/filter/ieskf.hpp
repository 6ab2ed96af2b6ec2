#pragma once
// The iterated error-state update of one scan, with directions that the scan does not constrain left to the prior.

#include "estimator/filter/imu_propagation.hpp"
#include "estimator/filter/point_to_plane.hpp"
#include "estimator/types/stage.hpp"

namespace slamd {

struct IeskfConfig {
  std::uint32_t max_iterations = 4;
  std::uint32_t max_iterations_unsure = 25;  // while the prior's position sigma is above associate_again_m
  double converged_translation_m = 5.0e-4;
  double converged_rotation_rad = 5.0e-5;
  double associate_again_m = 0.1;          // points moved further than this since their planes were found: find anew
  std::uint32_t min_inliers = 100;
  double min_inlier_share = 0.3;           // of the points with a plane
  double information_scale = 0.2;          // neighbouring residuals share their errors: one independent in five
  double degenerate_noise_ratio = 1.0;     // information below so many times what noisy normals faked is not believed
  double degenerate_share = 0.002;         // likewise below this share of all the residuals' information
  double degenerate_sigma_m = 0.01;        // of one scan in the other directions while one of position is free
  double unsure_sigma_m = 0.0;             // of one scan whose prior was not sure (associate_again_m); 0 = as any other
  double least_sigma_m = 0.0;              // of one scan in any case; 0 = what its residuals say
  bool estimate_extrinsic = false;
};

/// What one update did.
struct UpdateSummary {
  bool fused = false;
  bool sure = true;             // the prior knew the motion, so the scan is not skewed
  std::uint32_t iterations = 0;
  std::uint32_t matched = 0;
  std::uint32_t inliers = 0;
  Eigen::Vector3d corrected_mps = Eigen::Vector3d::Zero();  // velocity, posterior less prior, odom
  double attitude_correction = 0.0;   // by the scan, in squared sigmas of the prior
  double position_correction = 0.0;   // likewise
  double test_ratio = 0.0;      // mean squared normalised residual; points beyond the gate count as at it
  int free_translations = 0;    // directions of position and axes of attitude that the prior alone holds
  int free_rotations = 0;
  Eigen::Vector3d free_direction = Eigen::Vector3d::Zero();  // unit, odom: the least constrained one, if any is free
};

/// Iterated error-state update with one de-skewed scan. On success state and covariance are replaced by the posterior;
/// with fewer than min_inliers neither changes and `fused` is false. No allocation.
/// Source: Xu et al. 2022, eq. (14)-(18), in information form: (I + A P)^-1 over the measured rows only, so that a
/// singular A (free directions) and a singular P (extrinsic not estimated) are both fine.
/// listener, when there is one, hears of kAssociate and kSolve.
UpdateSummary update(const IeskfConfig& config, std::span<const MeasuredPoint> points, PointToPlane& residuals,
                     PlaneMap& map, FilterSnapshot& filter, StageListener* listener = nullptr);

}  // namespace slamd
