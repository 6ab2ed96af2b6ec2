#pragma once
// Point-to-plane registration of one sub-map on another, with the covariance that the scene gives it: large along what
// the scene leaves free. Whether it is the right place is not decided here.

#include <span>

#include "estimator/graph/relative_pose.hpp"
#include "estimator/map/plane_map.hpp"

namespace slamd {

struct SubmapRegistrationConfig {
  std::uint32_t max_points = 4'000;       // of the source, evenly chosen
  std::uint32_t max_iterations = 30;
  double coarse_gate_m = 1.0;             // correspondences at the first iterations; halved each until fine_gate_m
  double fine_gate_m = 0.25;
  double point_sigma_m = 0.03;            // of a point from its plane, beam noise and thinning together
  double information_scale = 0.05;        // neighbouring points share their errors
  double floor_sigma_m = 0.01;            // of the sub-maps' own shape, however well they match
  double floor_sigma_rad = 3.0e-4;
};

struct SubmapMatch {
  RelativePose T_target_source;  // level frames, with its covariance
  double inlier_share = 0.0;   // fitness: standing points that lie on the target's, of those where the target was seen
  double overlap = 0.0;        // points near any point of the target, of all
  double rms_m = 0.0;          // of the inliers
  std::uint32_t iterations = 0;
  bool converged = false;
};

/// A sub-map's surfaces, in its level frame.
PlaneMap surfaces(std::span<const Eigen::Vector3f> points);

/// Points of a sub-map, evenly chosen; those that stand are told from the ground, which is the same everywhere.
struct RegistrationPoints {
  std::vector<Eigen::Vector3f> points;  // level frame, metres
  std::vector<bool> standing;           // one a point
};

/// own_surfaces  of the same sub-map
RegistrationPoints choose_points(std::span<const Eigen::Vector3f> points, PlaneMap& own_surfaces,
                                 std::uint32_t max_points);

/// Moves `source` (its own level frame) onto `target` from a guess within about a metre and two degrees.
/// Source: Chen, Medioni 1992; covariance from the Hessian, less what the normals' own noise adds to it, scaled by
/// information_scale.
SubmapMatch register_submap(PlaneMap& target, const RegistrationPoints& source, const Pose& T_target_source,
                            const SubmapRegistrationConfig& config);

}  // namespace slamd
