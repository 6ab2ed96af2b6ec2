#pragma once
// The pose of a scan against a map of lines to a fraction of a cell: Gauss-Newton on distances of points to lines with the
// motion's own word as prior, and the covariance that the scene gives. It needs a start within some decimetres.

#include <Eigen/Core>

#include "estimator/grid/line_map.hpp"

namespace slamd {

struct LineMatcherConfig {
  int max_iterations = 20;
  double converged_m = 1e-4;        // smaller steps end it
  double converged_rad = 1e-5;
  double gate_m = 0.3;              // points farther from their line are left out
  double robust_sigmas = 2.0;       // beyond it a point counts less (Cauchy)
  double information_scale = 0.25;  // share of residuals that are independent
  double faked_margin = 4.0;        // times the information that noisy normals fake is taken off
  double degenerate_sigma_m = 0.1;  // a scan that alone knows a direction no better does not constrain it
  double degenerate_sigma_rad = 0.02;
  int least_inliers = 20;
  std::size_t most_points = 800;    // of a scan that take part, evenly chosen
};

/// What is known of a pose before the scan. Information of the error by right perturbation: x, y in base (m), yaw (rad).
struct PlanarPrior {
  PlanarPose T_map_base;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
};

struct LineMatch {
  PlanarPose T_map_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();   // of prior and scan together, as PlanarPrior::information
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();       // of the scan alone
  Eigen::Vector3d free_direction = Eigen::Vector3d::Zero();    // unit, that the scan does not constrain; zero: none
  int inliers = 0;             // points with a line near enough
  double inlier_share = 0.0;   // of the points
  double mean_square = 0.0;    // of their residuals in sigmas, robust: about 1 when the noise is told truly
  int iterations = 0;
  bool ok = false;             // false: too few inliers; the pose is the start's, the covariance the prior's
};

/// start  within some decimetres of the truth; may differ from the prior
LineMatch match_lines(const LineMap& map, const PlanarScan& scan, const PlanarPose& start,
                      const PlanarPrior& prior, const LineMatcherConfig& config);

/// The distance of a point of the base frame to a line, and its derivative by the pose's right perturbation.
double line_residual(const WallLine& line, const PlanarPose& T_map_base, const Eigen::Vector2d& p_base,
                     Eigen::RowVector3d* J_r_pose);

}  // namespace slamd
