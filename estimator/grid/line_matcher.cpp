#include "estimator/grid/line_matcher.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace slamd {
namespace {

struct NormalEquations {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d faked = Eigen::Matrix3d::Zero();  // what noise of the normals puts into H
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double squares = 0.0, weights = 0.0;
  int inliers = 0, tried = 0;
};

NormalEquations linearise(const LineMap& map, const PlanarScan& scan, const PlanarPose& T_map_base,
                          const LineMatcherConfig& config) {
  NormalEquations sum;
  WallLine line;
  const Eigen::Matrix2d R = T_map_base.rotation();
  const double robust2 = config.robust_sigmas * config.robust_sigmas;
  const std::size_t stride = scan.points.size() / config.most_points + 1;
  for (std::size_t i = 0; i < scan.points.size(); i += stride) {
    if (scan.normals[i].isZero()) continue;
    ++sum.tried;
    const Eigen::Vector2d p = scan.points[i].cast<double>();
    if (!map.line_at(R * p + T_map_base.translation, R * scan.normals[i].cast<double>(), line)) continue;
    const Eigen::Vector2d n = R.transpose() * line.normal;
    const double r = line.normal.dot(R * p + T_map_base.translation - line.mean);
    if (std::abs(r) > config.gate_m) continue;
    const Eigen::Vector3d J{n.x(), n.y(), n.y() * p.x() - n.x() * p.y()};
    const Eigen::Vector3d J_along{-n.y(), n.x(), n.x() * p.x() + n.y() * p.y()};
    const double square = r * r / line.variance_m2;
    const double weight = 1.0 / (1.0 + square / robust2);
    const double w = weight / line.variance_m2;
    sum.H += w * J * J.transpose();
    sum.faked += w * line.normal_variance * J_along * J_along.transpose();
    sum.g += w * r * J;
    sum.squares += weight * square;
    sum.weights += weight;
    ++sum.inliers;
  }
  return sum;
}

/// Nearest positive semidefinite matrix.
Eigen::Matrix3d without_negative(const Eigen::Matrix3d& m) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen{m};
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

/// The direction that the information knows worst, yaw counted in lengths of degenerate_sigma, when it is too bad.
Eigen::Vector3d free_direction(const Eigen::Matrix3d& information, const LineMatcherConfig& config) {
  const Eigen::Vector3d unit{config.degenerate_sigma_m, config.degenerate_sigma_m, config.degenerate_sigma_rad};
  const Eigen::Matrix3d scaled = unit.asDiagonal() * information * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen{scaled};
  if (eigen.eigenvalues()[0] >= 1.0) return Eigen::Vector3d::Zero();
  return (unit.asDiagonal() * eigen.eigenvectors().col(0)).normalized();
}

Eigen::Matrix3d inverse_of(const Eigen::Matrix3d& information) {
  constexpr double kNextToNothing = 1e-4;  // sigma of 100 m or rad
  return (information + kNextToNothing * Eigen::Matrix3d::Identity()).inverse();
}

void finish(LineMatch& match, const NormalEquations& sum, const PlanarPrior& prior, const LineMatcherConfig& config) {
  match.inliers = sum.inliers;
  match.inlier_share = sum.tried > 0 ? static_cast<double>(sum.inliers) / sum.tried : 0.0;
  match.mean_square = sum.weights > 0.0 ? sum.squares / sum.weights : 0.0;
  match.ok = sum.inliers >= config.least_inliers;
  if (!match.ok) return;
  const double scale = config.information_scale / std::max(1.0, match.mean_square);
  match.information = without_negative(scale * (sum.H - config.faked_margin * sum.faked));
  match.covariance = inverse_of(match.information + prior.information);
  match.free_direction = free_direction(match.information, config);
}

}  // namespace

double line_residual(const WallLine& line, const PlanarPose& T_map_base, const Eigen::Vector2d& p_base,
                     Eigen::RowVector3d* J_r_pose) {
  const Eigen::Matrix2d R = T_map_base.rotation();
  if (J_r_pose != nullptr) {
    const Eigen::Vector2d n = R.transpose() * line.normal;
    *J_r_pose << n.x(), n.y(), n.y() * p_base.x() - n.x() * p_base.y();
  }
  return line.normal.dot(R * p_base + T_map_base.translation - line.mean);
}

LineMatch match_lines(const LineMap& map, const PlanarScan& scan, const PlanarPose& start,
                      const PlanarPrior& prior, const LineMatcherConfig& config) {
  LineMatch match{.T_map_base = start, .covariance = inverse_of(prior.information)};
  NormalEquations sum;
  for (; match.iterations < config.max_iterations; ++match.iterations) {
    sum = linearise(map, scan, match.T_map_base, config);
    if (sum.inliers < config.least_inliers) break;
    const Eigen::Vector3d e = GroupSe2::minus(match.T_map_base, prior.T_map_base);
    const Eigen::Matrix3d A = config.information_scale * sum.H + prior.information;
    const Eigen::Vector3d b = config.information_scale * sum.g + prior.information * e;
    const Eigen::Vector3d step = -A.ldlt().solve(b);
    if (!step.allFinite()) break;
    match.T_map_base = GroupSe2::plus(match.T_map_base, step);
    if (step.head<2>().norm() < config.converged_m && std::abs(step[2]) < config.converged_rad) break;
  }
  finish(match, sum, prior, config);
  if (!match.ok) match.T_map_base = start;
  return match;
}

}  // namespace slamd
