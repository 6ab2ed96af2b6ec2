#include "tools/imu-monitor/allan.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamd::monitor {
namespace {

constexpr int kTimesPerDecade = 20;
constexpr std::size_t kFewestSamples = 30;
constexpr std::size_t kFewestClusters = 9;  // the last points of a curve are of few differences and mislead
constexpr double kFlat = 2.0 * std::numbers::ln2 / std::numbers::pi;
constexpr double kFlatEnd = 0.7;  // the lowest point lies before this share of the longest time: the flat part was seen

/// The signal's integral, without its mean: that keeps the digits, and the second difference does not see it.
std::vector<double> integral(std::span<const double> samples, double period_s) {
  double mean = 0.0;
  for (const double sample : samples) mean += sample;
  mean /= static_cast<double>(samples.size());
  std::vector<double> sum(samples.size() + 1, 0.0);
  for (std::size_t i = 0; i < samples.size(); ++i) sum[i + 1] = sum[i] + (samples[i] - mean) * period_s;
  return sum;
}

AllanPoint point_at(const std::vector<double>& theta, std::size_t m, double period_s) {
  const std::size_t count = theta.size() - 2 * m;
  double squares = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double difference = theta[i + 2 * m] - 2.0 * theta[i + m] + theta[i];
    squares += difference * difference;
  }
  const double tau = static_cast<double>(m) * period_s;
  return {tau, std::sqrt(squares / (2.0 * tau * tau * static_cast<double>(count))),
          static_cast<double>(count) / static_cast<double>(m)};
}

/// Least squares with all unknowns >= 0: the best of the few sets of unknowns that may be positive.
Eigen::Vector3d non_negative_fit(const Eigen::MatrixX3d& a, const Eigen::VectorXd& b) {
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  double best_cost = b.squaredNorm();
  for (unsigned set = 1; set < 8; ++set) {
    Eigen::MatrixX3d chosen = a;
    for (int i = 0; i < 3; ++i) {
      if ((set >> static_cast<unsigned>(i) & 1U) == 0) chosen.col(i).setZero();
    }
    const Eigen::Vector3d x = chosen.completeOrthogonalDecomposition().solve(b);
    const double cost = (a * x - b).squaredNorm();
    if (x.minCoeff() < 0.0 || cost >= best_cost) continue;
    best = x;
    best_cost = cost;
  }
  return best;
}

}  // namespace

std::vector<AllanPoint> allan_deviation(std::span<const double> samples, double period_s) {
  std::vector<AllanPoint> curve;
  if (samples.size() < kFewestSamples || !(period_s > 0.0)) return curve;
  const std::vector<double> theta = integral(samples, period_s);
  const std::size_t longest = samples.size() / kFewestClusters;
  const double ratio = std::pow(10.0, 1.0 / kTimesPerDecade);
  std::size_t last = 0;
  for (double m = 1.0; m <= static_cast<double>(longest); m *= ratio) {
    const auto steps = static_cast<std::size_t>(std::lround(m));
    if (steps == last || steps > longest) continue;
    curve.push_back(point_at(theta, steps, period_s));
    last = steps;
  }
  return curve;
}

AllanFigures allan_figures(std::span<const AllanPoint> curve) {
  AllanFigures figures;
  if (curve.empty()) return figures;
  const auto rows = static_cast<Eigen::Index>(curve.size());
  Eigen::MatrixX3d a(rows, 3);
  Eigen::VectorXd b = Eigen::VectorXd::Ones(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const AllanPoint& p = curve[static_cast<std::size_t>(i)];
    const double variance = std::max(p.deviation * p.deviation, 1e-300);
    const double weight = std::sqrt(p.freedom);
    a.row(i) << 1.0 / p.tau_s, kFlat, p.tau_s / 3.0;
    a.row(i) *= weight / variance;
    b[i] *= weight;
  }
  // columns to length 1: N^2 and K^2 are many powers of ten apart
  const Eigen::Vector3d scale = a.colwise().norm().transpose();
  const Eigen::Vector3d scaled = non_negative_fit(a * scale.cwiseInverse().asDiagonal(), b);
  const Eigen::Vector3d squares = scaled.cwiseQuotient(scale);
  const auto lowest = std::ranges::min_element(curve, {}, &AllanPoint::deviation);
  figures.noise_density = std::sqrt(squares[0]);
  figures.random_walk = std::sqrt(squares[2]);
  figures.bias_instability = lowest->deviation / std::sqrt(kFlat);
  figures.flat_tau_s = lowest->tau_s;
  figures.flat_is_reached = lowest->tau_s < kFlatEnd * curve.back().tau_s;
  return figures;
}

}  // namespace slamd::monitor
