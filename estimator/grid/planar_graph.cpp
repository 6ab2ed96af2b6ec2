#include "estimator/grid/planar_graph.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "estimator/graph/pose_graph.hpp"
#include "estimator/graph/robust_loss.hpp"

namespace slamd {
namespace {

constexpr double kLeastSigma_m = 1e-4;    // no step of odometry is surer
constexpr double kLeastSigma_rad = 1e-5;
constexpr double kTightening = 4.0;       // of the loss from one pass to the next

Eigen::Matrix3d information_of(const Eigen::Matrix3d& covariance) {
  Eigen::Matrix3d floored = covariance;
  floored.diagonal() += Eigen::Vector3d{kLeastSigma_m, kLeastSigma_m, kLeastSigma_rad}.cwiseAbs2();
  const Eigen::Matrix3d information = floored.llt().solve(Eigen::Matrix3d::Identity());
  return 0.5 * (information + information.transpose());
}

/// How many closures have the error of this one, itself included.
double shared_by(const std::vector<PlanarClosure>& closures, const PlanarClosure& closure, const PlanarNodes& nodes,
                 const PlanarGraphConfig& config) {
  const auto near = [&](std::uint64_t a, std::uint64_t b) {
    return std::abs(nodes[a - nodes.front().id].way_m - nodes[b - nodes.front().id].way_m) <= config.neighbours_m;
  };
  const auto count = std::ranges::count_if(
      closures, [&](const PlanarClosure& other) { return near(other.from, closure.from) && near(other.to, closure.to); });
  return std::min(static_cast<double>(count), config.closure_correlation);
}

PoseGraph<GroupSe2> chain_of(const PlanarNodes& nodes) {
  PoseGraph<GroupSe2> graph;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    graph.poses.push_back(nodes[i].T_map_base);
    graph.fixed.push_back(i == 0);
    if (i == 0) continue;
    const PlanarPose step = nodes[i - 1].T_odom_base.inverse() * nodes[i].T_odom_base;
    graph.edges.push_back({i - 1, i, step, information_of(nodes[i].relative_covariance)});
  }
  return graph;
}

}  // namespace

SolveOutcome solve_planar_graph(PlanarNodes& nodes, std::vector<PlanarClosure>& closures, const PlanarGraphConfig& config,
                                const SolveLimits& limits) {
  SolveOutcome outcome;
  if (nodes.size() < 2) return outcome;
  PoseGraph<GroupSe2> graph = chain_of(nodes);
  DcsLoss loss{config.closure_phi};
  GraphProblem<GroupSe2> problem{graph.poses, graph.fixed};
  for (const Edge<GroupSe2>& edge : graph.edges) problem.add(edge, graph.rotation_error);
  std::vector<ceres::ResidualBlockId> blocks;
  for (const PlanarClosure& closure : closures) {
    const Eigen::Matrix3d covariance = shared_by(closures, closure, nodes, config) * closure.covariance;
    const std::uint64_t first = nodes.front().id;
    const Edge<GroupSe2> edge{closure.from - first, closure.to - first, closure.T_from_to, information_of(covariance)};
    blocks.push_back(problem.add(edge, graph.rotation_error, &loss));
  }
  const auto chi2 = [&](ceres::ResidualBlockId id) {
    double cost = 0.0;
    problem.problem().EvaluateResidualBlock(id, false, &cost, nullptr, nullptr);
    return 2.0 * cost;
  };
  const auto worst = [&] {
    double largest = 0.0;
    for (const ceres::ResidualBlockId id : blocks) largest = std::max(largest, chi2(id));
    return largest;
  };
  for (double phi = std::max(config.closure_phi, worst());;) {
    loss.set_phi(phi);
    outcome = minimise(problem.problem(), limits);
    if (phi <= config.closure_phi || !outcome.usable || outcome.cancelled) break;
    phi = std::max(config.closure_phi, std::min(phi / kTightening, worst()));
  }
  if (!outcome.usable) return outcome;
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i].T_map_base = problem.pose(i);
  for (std::size_t i = 0; i < closures.size(); ++i) closures[i].weight = loss.weight(chi2(blocks[i]));
  return outcome;
}

}  // namespace slamd
