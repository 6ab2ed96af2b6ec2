#include "estimator/grid/planar_loop_closer.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "estimator/grid/planar_covariance.hpp"

namespace slamd {
namespace {

constexpr int kLevels = 8;             // blocks up to 128 cells: 6.4 m
constexpr double kNextToNoPrior = 1e-2;  // information: 10 m, 10 rad
constexpr double kLeastWindow_m = 0.3;
constexpr double kLeastWindow_rad = 0.05;

LikelihoodConfig with_levels(LikelihoodConfig config) {
  config.levels = kLevels;
  return config;
}

void append(PlanarScan& out, const PlanarScan& scan, const PlanarPose& T_out_scan) {
  const Eigen::Matrix2f R = T_out_scan.rotation().cast<float>();
  const Eigen::Vector2f t = T_out_scan.translation.cast<float>();
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    out.points.emplace_back(R * scan.points[i] + t);
    out.normals.emplace_back(R * scan.normals[i]);
  }
}

}  // namespace

PlanarLoopCloser::PlanarLoopCloser(const PlanarLoopConfig& config, const LineMapConfig& lines,
                                   const LikelihoodConfig& likelihood, const LineMatcherConfig& matcher)
    : config_{config}, matcher_{matcher}, lines_{lines}, likelihood_{with_levels(likelihood)} {}

/// Odometry's word on where `to` lies from `from`: covariance in the base of `to`.
Eigen::Matrix3d PlanarLoopCloser::drift(const PlanarNodes& nodes, std::size_t from, std::size_t to) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = from + 1; i <= to; ++i) {
    const Eigen::Matrix3d ad = planar_adjoint(nodes[i].T_odom_base.inverse() * nodes[i - 1].T_odom_base);
    sum = ad * sum * ad.transpose() + nodes[i].relative_covariance;
  }
  return sum;
}

/// The nearest node among those that were left long enough ago.
std::optional<std::size_t> PlanarLoopCloser::candidate(const PlanarNodes& nodes, std::size_t newest) const {
  std::optional<std::size_t> best;
  double nearest = config_.most_radius_m;
  const double least_way_m = std::max<double>(config_.least_way_m, config_.least_way_ranges * nodes[newest].scan.mean_range_m);
  for (std::size_t i = 0; i < newest && nodes[newest].way_m - nodes[i].way_m > least_way_m; ++i) {
    const double distance = (nodes[i].T_map_base.translation - nodes[newest].T_map_base.translation).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    best = i;
  }
  if (!best || nearest <= config_.radius_m) return best;
  const double sigma_m = std::sqrt(drift(nodes, *best, newest).topLeftCorner<2, 2>().trace());
  return nearest <= config_.sigmas * sigma_m ? best : std::nullopt;
}

void PlanarLoopCloser::build_map(const PlanarNodes& nodes, std::size_t middle, std::size_t end) {
  lines_.clear();
  likelihood_.clear();
  const PlanarPose T_middle_map = nodes[middle].T_map_base.inverse();
  const double reach_m = std::max<double>(config_.reach_m, config_.reach_ranges * nodes[middle].scan.mean_range_m);
  for (std::size_t i = 0; i < end; ++i) {
    if (std::abs(nodes[i].way_m - nodes[middle].way_m) > reach_m) continue;
    const PlanarPose T_middle_base = T_middle_map * nodes[i].T_map_base;
    lines_.add(nodes[i].scan, T_middle_base);
    likelihood_.add(nodes[i].scan.points, T_middle_base);
  }
}

PlanarScan PlanarLoopCloser::stretch(const PlanarNodes& nodes, std::size_t newest) const {
  PlanarScan out;
  out.time = nodes[newest].scan.time;
  const double stretch_m = std::max<double>(config_.stretch_m, 0.5 * config_.reach_ranges * nodes[newest].scan.mean_range_m);
  const PlanarPose T_newest_odom = nodes[newest].T_odom_base.inverse();
  for (std::size_t i = newest + 1; i-- > 0 && nodes[newest].way_m - nodes[i].way_m <= stretch_m;) {
    append(out, nodes[i].scan, T_newest_odom * nodes[i].T_odom_base);
  }
  return out;
}

std::optional<PlanarPose> PlanarLoopCloser::search(const PlanarScan& scan, const PlanarPose& guess, const Eigen::Matrix3d& drift) {
  std::vector<Eigen::Vector2f> sample;
  const std::size_t stride = scan.points.size() / config_.search_points + 1;
  for (std::size_t i = 0; i < scan.points.size(); i += stride) sample.push_back(scan.points[i]);
  SearchWindow window;
  window.centre = guess;
  window.half_width_m = std::clamp(config_.sigmas * std::sqrt(drift.topLeftCorner<2, 2>().trace()), kLeastWindow_m, config_.most_radius_m);
  window.half_yaw_rad = std::clamp(config_.sigmas * std::sqrt(drift(2, 2)), kLeastWindow_rad, config_.most_yaw_rad);
  window.least_score = config_.least_score;
  window.most_looks = config_.search_looks;
  const std::optional<CorrelativeMatch> found = correlative_.match(likelihood_, sample, window);
  // An unfinished search may have missed the place: what it has is not believed.
  if (!found || !found->exact) return std::nullopt;
  return found->T_map_base;
}

std::optional<PlanarClosure> PlanarLoopCloser::look(const PlanarNodes& nodes, std::size_t newest) {
  const std::optional<std::size_t> place = candidate(nodes, newest);
  if (!place) return std::nullopt;
  build_map(nodes, *place, newest);
  const PlanarScan scan = stretch(nodes, newest);
  const Eigen::Matrix3d odometry = drift(nodes, *place, newest);
  const PlanarPose guess = nodes[*place].T_map_base.inverse() * nodes[newest].T_map_base;
  const std::optional<PlanarPose> start = search(scan, guess, odometry);
  if (!start) return std::nullopt;
  const PlanarPrior none{*start, kNextToNoPrior * Eigen::Matrix3d::Identity()};
  const LineMatch match = match_lines(lines_, scan, *start, none, matcher_);
  const double least_share = std::max(config_.least_inlier_share, config_.least_own_share * nodes[newest].inlier_share);
  if (!match.ok || match.inlier_share < least_share || match.mean_square > config_.most_mean_square) return std::nullopt;
  PlanarClosure closure{nodes[*place].id, nodes[newest].id, match.T_map_base, match.covariance, 1.0};
  closure.covariance += nodes[newest].match_covariance;
  closure.covariance.diagonal() += Eigen::Vector3d{config_.floor_sigma_m, config_.floor_sigma_m, config_.floor_sigma_rad}.cwiseAbs2();
  const PlanarPose by_odometry = nodes[*place].T_odom_base.inverse() * nodes[newest].T_odom_base;
  const GroupSe2::Tangent e = GroupSe2::minus(by_odometry, closure.T_from_to);
  const double distance2 = e.dot((odometry + closure.covariance).ldlt().solve(e));
  if (distance2 > 3.0 * config_.gate_sigmas * config_.gate_sigmas) return std::nullopt;
  return closure;
}

}  // namespace slamd
