#include "estimator/graph/submap_registration.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace slamd {

namespace {

constexpr float kSeen_m = 1.0F;               // from a point of the target: it saw the place
constexpr float kSameThing_m = 0.4F;          // likewise, where there is no plane: foliage, poles
constexpr float kGroundNormal = 0.8F;         // vertical share of a normal from which a surface is ground
constexpr double kLever_m = 10.0;
constexpr double kNormalNoiseFactor = 4.0;    // neighbouring points share their plane and so its noise
constexpr double kConverged_m = 5.0e-4;
constexpr double kConverged_rad = 2.0e-5;
constexpr double kPriorInformation = 1.0e-4;  // keeps a free direction where it was, far below any real measurement
constexpr double kCauchy2 = 9.0;              // squared sigmas from which a contact counts half

struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Matrix6d H_normals = Matrix6d::Zero();  // the part of H that noise of the normals makes on average
  Vector6d g = Vector6d::Zero();
  double squares = 0.0;
  std::uint32_t inliers = 0;
};

/// Jacobian of n.(T Exp(e) p) by e.
Vector6d jacobian(const Eigen::Vector3d& n, const Pose& T, const Eigen::Vector3d& p) {
  const Eigen::Vector3d n_source = T.rotation.conjugate() * n;
  Vector6d J;
  J.head<3>() = n_source;
  J.tail<3>() = p.cross(n_source);
  return J;
}

double offset_m(const Plane& plane, const Eigen::Vector3d& p) {
  return plane.normal.cast<double>().dot(p - plane.centre.cast<double>());
}

/// Adds one residual n.(T p - c), Cauchy-weighted. The point scatters about its surface as the plane's own points do. Tilt
/// noise of the normal adds to H too, on average: directions that only noise "sees" are free.
void add(NormalEquations& equations, const Plane& plane, const Pose& T, const Eigen::Vector3d& p, double point_variance_m2) {
  const Eigen::Vector3d at = T * p;
  const double residual = offset_m(plane, at);
  const double variance_m2 = point_variance_m2 + plane.variance_m2 + plane.height_variance(at.cast<float>());
  const double weight = 1.0 / (variance_m2 + residual * residual / kCauchy2);
  const Vector6d J = jacobian(plane.normal.cast<double>(), T, p);
  equations.H += weight * J * J.transpose();
  equations.g -= weight * residual * J;
  equations.squares += residual * residual;
  ++equations.inliers;
  for (const Plane::Tilt& tilt : plane.tilts()) {
    const Vector6d J_tilt = jacobian(tilt.towards.cast<double>(), T, p);
    equations.H_normals += weight * tilt.variance * J_tilt * J_tilt.transpose();
  }
}

/// Of `points` held against `planes`, by a perturbation of T_planes_points.
NormalEquations linearise(PlaneMap& planes, std::span<const Eigen::Vector3f> points, const Pose& T_planes_points,
                          double gate_m, double point_variance_m2) {
  NormalEquations equations;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3d at = T_planes_points * p.cast<double>();
    const Plane* plane = planes.plane_at(at.cast<float>());
    if (plane == nullptr || std::abs(offset_m(*plane, at)) > gate_m) continue;
    add(equations, *plane, T_planes_points, p.cast<double>(), point_variance_m2);
  }
  return equations;
}

/// Each sub-map's points held against the planes of the other, by a perturbation of T_target_source.
NormalEquations linearise(SubmapShape& target, SubmapShape& source, const Pose& T_target_source, double gate_m,
                          const SubmapRegistrationConfig& config) {
  const double point_variance_m2 = config.point_sigma_m * config.point_sigma_m;
  NormalEquations equations = linearise(target.planes, source.points, T_target_source, gate_m, point_variance_m2);
  const NormalEquations back = linearise(source.planes, target.points, T_target_source.inverse(), gate_m, point_variance_m2);
  // (T Exp(e))^-1 = T^-1 Exp(-Ad(T) e)
  const Matrix6d Ad = adjoint(T_target_source);
  equations.H += Ad.transpose() * back.H * Ad + kPriorInformation * Matrix6d::Identity();
  equations.H_normals += Ad.transpose() * back.H_normals * Ad;
  equations.g -= Ad.transpose() * back.g;
  equations.squares += back.squares;
  equations.inliers += back.inliers;
  return equations;
}

void measure(PlaneMap& target, const SubmapShape& source, double gate_m, SubmapMatch& match) {
  std::size_t near = 0;
  std::size_t standing = 0;
  std::size_t fitting = 0;
  for (std::size_t i = 0; i < source.points.size(); ++i) {
    const Eigen::Vector3d at = match.T_target_source.T_a_b * source.points[i].cast<double>();
    Neighbour nearest{};
    if (target.tree().nearest(at.cast<float>(), {&nearest, 1}, kSeen_m) == 0) continue;
    ++near;
    if (!source.standing[i]) continue;
    ++standing;
    const Plane* plane = target.plane_at(at.cast<float>());
    const bool fits = plane != nullptr ? std::abs(offset_m(*plane, at)) < gate_m
                                       : nearest.squared_distance_m2 < kSameThing_m * kSameThing_m;
    fitting += fits ? 1 : 0;
  }
  const auto share = [](std::size_t part, std::size_t all) {
    return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
  };
  match.overlap = share(near, source.points.size());
  match.inlier_share = share(fitting, standing);
}

/// The inverse of the information; where the normals' noise explains what there is, the prior's.
Matrix6d covariance_of(const NormalEquations& equations, const SubmapRegistrationConfig& config) {
  Vector6d scale = Vector6d::Ones();
  scale.tail<3>().setConstant(1.0 / kLever_m);  // so that one unit of either moves the points equally far
  const Matrix6d H = config.information_scale * (equations.H - kNormalNoiseFactor * equations.H_normals);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver{scale.asDiagonal() * H * scale.asDiagonal()};
  const Vector6d variances = solver.eigenvalues().cwiseMax(kPriorInformation).cwiseInverse();
  const Matrix6d inverse = solver.eigenvectors() * variances.asDiagonal() * solver.eigenvectors().transpose();
  Matrix6d covariance = scale.asDiagonal() * inverse * scale.asDiagonal();
  covariance.topLeftCorner<3, 3>().diagonal().array() += config.floor_sigma_m * config.floor_sigma_m;
  covariance.bottomRightCorner<3, 3>().diagonal().array() += config.floor_sigma_rad * config.floor_sigma_rad;
  return covariance;
}

/// At least as many as the points have voxels: the map takes all its memory at once, and points share voxels.
std::uint32_t voxels_of(std::span<const Eigen::Vector3f> points, float voxel_size_m) {
  constexpr std::size_t kMost = 100'000;
  constexpr std::size_t kMargin = 64;  // for points on the edge of two, which rounding may count as one
  const auto along = [&](float coordinate) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(coordinate / voxel_size_m))) & 0x1F'FFFFU;
  };
  std::vector<std::uint64_t> voxels;
  voxels.reserve(points.size());
  for (const Eigen::Vector3f& p : points) voxels.push_back(along(p.x()) << 42U | along(p.y()) << 21U | along(p.z()));
  std::ranges::sort(voxels);
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return static_cast<std::uint32_t>(std::min(voxels.size() + voxels.size() / 64 + kMargin, kMost));
}

PlaneMap planes_of(std::span<const Eigen::Vector3f> points) {
  PlaneMapConfig config{.max_voxel_weight = 1'000};
  config.max_voxels = voxels_of(points, config.voxel_size_m);
  PlaneMap map{config};
  for (const Eigen::Vector3f& p : points) map.insert(p);
  return map;
}

}  // namespace

SubmapShape shape_of(std::span<const Eigen::Vector3f> points, std::uint32_t max_points) {
  SubmapShape shape{.planes = planes_of(points), .points = {}, .standing = {}};
  const std::size_t stride = points.size() / max_points + 1;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const Plane* plane = shape.planes.plane_at(points[i]);
    shape.points.push_back(points[i]);
    shape.standing.push_back(plane == nullptr || std::abs(plane->normal.z()) < kGroundNormal);
  }
  return shape;
}

SubmapMatch register_submap(SubmapShape& target, SubmapShape& source, const Pose& T_target_source,
                            const SubmapRegistrationConfig& config) {
  SubmapMatch match{.T_target_source = {.T_a_b = T_target_source}};
  Pose& T = match.T_target_source.T_a_b;
  double gate_m = config.coarse_gate_m;
  NormalEquations equations;
  while (match.iterations < config.max_iterations && !match.converged) {
    equations = linearise(target, source, T, gate_m, config);
    const Vector6d step = equations.H.ldlt().solve(equations.g);
    if (!step.allFinite()) return match;
    T = boxplus(T, step);
    ++match.iterations;
    const bool still = step.head<3>().norm() < kConverged_m && step.tail<3>().norm() < kConverged_rad;
    match.converged = still && gate_m <= config.fine_gate_m;
    gate_m = std::max(0.7 * gate_m, config.fine_gate_m);
  }
  equations = linearise(target, source, T, config.fine_gate_m, config);
  match.rms_m = equations.inliers == 0 ? 0.0 : std::sqrt(equations.squares / equations.inliers);
  match.T_target_source.covariance = covariance_of(equations, config);
  measure(target.planes, source, config.fine_gate_m, match);
  return match;
}

}  // namespace slamd
