#include "estimator/graph/enu_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slamd {

namespace {

constexpr double kInlierSigmas = 3.0;
constexpr std::size_t kTrials = 150;
constexpr std::size_t kMostTested = 400;   // pairs that a trial is judged by, evenly chosen
constexpr int kRefinements = 8;
constexpr double kHeightLeftOut_m = 100.0;  // sigma of a height from which on it is not used

struct Planar {
  double yaw_rad = 0.0;
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();
  Eigen::Vector2d operator*(const Eigen::Vector2d& p) const { return Eigen::Rotation2Dd{yaw_rad} * p + translation; }
};

double normalised_m(const Planar& T, const EnuPair& pair) {
  return (pair.p_enu.head<2>() - T * pair.p_map.head<2>()).norm() / pair.sigma_m.x();
}

/// Weighted least squares of a turn and a shift.
Planar align(std::span<const EnuPair> pairs, std::span<const double> weights) {
  double sum = 0.0;
  Eigen::Vector2d mean_map = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_enu = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    sum += weights[i];
    mean_map += weights[i] * pairs[i].p_map.head<2>();
    mean_enu += weights[i] * pairs[i].p_enu.head<2>();
  }
  mean_map /= sum;
  mean_enu /= sum;
  double along = 0.0;
  double across = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector2d a = pairs[i].p_map.head<2>() - mean_map;
    const Eigen::Vector2d b = pairs[i].p_enu.head<2>() - mean_enu;
    along += weights[i] * a.dot(b);
    across += weights[i] * (a.x() * b.y() - a.y() * b.x());
  }
  Planar T{.yaw_rad = std::atan2(across, along)};
  T.translation = mean_enu - Eigen::Rotation2Dd{T.yaw_rad} * mean_map;
  return T;
}

Planar through(const EnuPair& a, const EnuPair& b) {
  const Eigen::Vector2d d_map = (b.p_map - a.p_map).head<2>();
  const Eigen::Vector2d d_enu = (b.p_enu - a.p_enu).head<2>();
  Planar T{.yaw_rad = std::atan2(d_enu.y(), d_enu.x()) - std::atan2(d_map.y(), d_map.x())};
  const Eigen::Vector2d middle_map = 0.5 * (a.p_map + b.p_map).head<2>();
  T.translation = 0.5 * (a.p_enu + b.p_enu).head<2>() - Eigen::Rotation2Dd{T.yaw_rad} * middle_map;
  return T;
}

std::size_t count_inliers(std::span<const EnuPair> pairs, const Planar& T) {
  const std::size_t stride = pairs.size() / kMostTested + 1;
  std::size_t count = 0;
  for (std::size_t i = 0; i < pairs.size(); i += stride) count += normalised_m(T, pairs[i]) < kInlierSigmas ? 1 : 0;
  return count;
}

/// The hypothesis with most inliers, of pairs some way apart, in an order that depends on nothing but their number.
Planar consensus(std::span<const EnuPair> pairs) {
  Planar best;
  std::size_t most = 0;
  const std::size_t n = pairs.size();
  for (std::size_t trial = 0; trial < kTrials; ++trial) {
    const std::size_t i = trial * 7919 % n;
    const std::size_t j = (i + n / 4 + trial * 104'729 % (n / 2 + 1)) % n;
    if (i == j) continue;
    const Planar T = through(pairs[i], pairs[j]);
    const std::size_t inliers = count_inliers(pairs, T);
    if (inliers <= most) continue;
    most = inliers;
    best = T;
  }
  return best;
}

/// The mean of what lies within three sigma of the median.
double height_m(std::span<const EnuPair> pairs, const std::vector<bool>& inlier) {
  std::vector<std::pair<double, double>> steps;  // height and sigma
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!inlier[i] || pairs[i].sigma_m.z() >= kHeightLeftOut_m) continue;
    steps.emplace_back(pairs[i].p_enu.z() - pairs[i].p_map.z(), pairs[i].sigma_m.z());
  }
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  const double median_m = middle->first;
  double sum = 0.0;
  double count = 0.0;
  for (const auto& [step_m, sigma_m] : steps) {
    if (std::abs(step_m - median_m) > kInlierSigmas * sigma_m) continue;
    sum += step_m;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : median_m;
}

/// Of the alignment at map's origin, from the spread of the inliers and the number of independent errors among them.
Matrix4d covariance(std::span<const EnuPair> pairs, const std::vector<bool>& inlier, const Planar& T) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double count = 0.0;
  double independent = 0.0;
  double sigma2 = 0.0;
  double sigma2_up = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!inlier[i]) continue;
    mean += pairs[i].p_map.head<2>();
    sigma2 += pairs[i].sigma_m.x() * pairs[i].sigma_m.x();
    sigma2_up += pairs[i].sigma_m.z() * pairs[i].sigma_m.z();
    count += 1.0;
    independent += pairs[i].share;
  }
  mean /= count;
  independent = std::max(1.0, independent);
  double spread2 = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (inlier[i]) spread2 += (pairs[i].p_map.head<2>() - mean).squaredNorm() / count;
  }
  const double yaw_variance = sigma2 / count / independent / std::max(spread2, 1e-6);
  const Eigen::Vector2d lever = Eigen::Rotation2Dd{T.yaw_rad} * mean;
  const Eigen::Vector2d d_yaw{lever.y(), -lever.x()};  // of the origin's shift, the middle of the track standing still
  Matrix4d P = Matrix4d::Zero();
  P.topLeftCorner<2, 2>() =
      sigma2 / count / independent * Eigen::Matrix2d::Identity() + yaw_variance * d_yaw * d_yaw.transpose();
  P.block<2, 1>(0, 3) = yaw_variance * d_yaw;
  P.block<1, 2>(3, 0) = P.block<2, 1>(0, 3).transpose();
  P(2, 2) = sigma2_up / count / independent;
  P(3, 3) = yaw_variance;
  return P;
}

}  // namespace

std::optional<EnuFit> fit_enu(std::span<const EnuPair> pairs, const EnuFitConfig& config) {
  if (pairs.size() < config.min_fixes) return std::nullopt;
  Planar T = consensus(pairs);
  std::vector<double> weights(pairs.size());
  for (int refinement = 0; refinement < kRefinements; ++refinement) {
    double sum = 0.0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double r = normalised_m(T, pairs[i]);
      weights[i] = r < 2.0 * kInlierSigmas ? 1.0 / (pairs[i].sigma_m.x() * pairs[i].sigma_m.x() * (1.0 + r * r / 4.0)) : 0.0;
      sum += weights[i];
    }
    if (sum <= 0.0) return std::nullopt;
    T = align(pairs, weights);
  }
  EnuFit fit;
  std::size_t inliers = 0;
  for (const EnuPair& pair : pairs) {
    fit.inlier.push_back(normalised_m(T, pair) < kInlierSigmas);
    inliers += fit.inlier.back() ? 1 : 0;
  }
  fit.inlier_share = static_cast<double>(inliers) / static_cast<double>(pairs.size());
  if (inliers < config.min_fixes || fit.inlier_share < config.min_inlier_share) return std::nullopt;
  fit.alignment.yaw_rad = std::remainder(T.yaw_rad, 2.0 * M_PI);
  fit.alignment.translation << T.translation, height_m(pairs, fit.inlier);
  fit.alignment.covariance = covariance(pairs, fit.inlier, T);
  if (std::sqrt(fit.alignment.covariance(3, 3)) > config.max_yaw_sigma_rad) return std::nullopt;
  return fit;
}

}  // namespace slamd
