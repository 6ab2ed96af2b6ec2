#pragma once
// Point-to-plane registration of one sub-map on another, with the covariance that the scene gives it: large along what
// the scene leaves free. Whether it is the right place is not decided here.

#include <span>

#include "estimator/graph/relative_pose.hpp"
#include "estimator/map/plane_map.hpp"

namespace slamd {

struct SubmapRegistrationConfig {
  std::uint32_t max_points = 4'000;       // of each sub-map, evenly chosen
  std::uint32_t max_iterations = 30;
  double coarse_gate_m = 1.0;             // correspondences at the first iteration; narrower at each until fine_gate_m
  double fine_gate_m = 0.25;
  double point_sigma_m = 0.01;            // of a point from a surface that has no thickness: what packing left of it
  double information_scale = 0.05;        // neighbouring points share their errors
  double floor_sigma_m = 0.004;           // of the sub-maps' own shape, however well they match
  double floor_sigma_rad = 1.5e-4;
};

struct SubmapMatch {
  RelativePose T_target_source;  // level frames, with its covariance
  double inlier_share = 0.0;   // fitness: standing points that lie on the target's, of those where the target was seen
  double overlap = 0.0;        // points near any point of the target, of all
  double rms_m = 0.0;          // of the inliers
  std::uint32_t iterations = 0;
  bool converged = false;
};

/// A sub-map as registration takes it, in its level frame, metres. Planes are fitted when they are asked for, so it changes.
struct SubmapShape {
  PlaneMap planes;
  std::vector<Eigen::Vector3f> points;  // evenly chosen
  std::vector<bool> standing;           // one a point: not the ground, which is the same everywhere
};

SubmapShape shape_of(std::span<const Eigen::Vector3f> points, std::uint32_t max_points);

/// Moves `source` (its own level frame) onto `target` from a guess within about a metre and two degrees. The points of each are
/// held against the planes of the other, each as much as its plane is thin: a wall counts more than a hedge.
/// Source: Chen, Medioni 1992; covariance from the Hessian, less what the normals' own noise adds to it, scaled by
/// information_scale.
SubmapMatch register_submap(SubmapShape& target, SubmapShape& source, const Pose& T_target_source,
                            const SubmapRegistrationConfig& config);

}  // namespace slamd
