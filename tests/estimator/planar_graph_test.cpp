// Two rounds of a circle whose odometry drifts: closures straighten them, wrong ones among them are found out.
#include "estimator/grid/planar_graph.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace slamd {
namespace {

constexpr double kRadius_m = 10.0;
constexpr std::size_t kRound = 120;
constexpr double kSigma_m = 0.01, kSigma_rad = 0.003;

PlanarPose truth(std::size_t i) {
  const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / kRound;
  return {{kRadius_m * std::sin(angle), kRadius_m * (1.0 - std::cos(angle))}, angle};
}

PlanarNodes drive(std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal;
  PlanarNodes nodes;
  for (std::size_t i = 0; i <= 2 * kRound; ++i) {
    PlanarNode node;
    node.id = i;
    node.way_m = static_cast<double>(i) * 2.0 * std::numbers::pi * kRadius_m / kRound;
    node.relative_covariance = Eigen::Vector3d{kSigma_m, kSigma_m, kSigma_rad}.cwiseAbs2().asDiagonal();
    if (i > 0) {
      const PlanarPose step = truth(i - 1).inverse() * truth(i);
      node.T_odom_base = nodes.back().T_odom_base *
                         GroupSe2::plus(step, {kSigma_m * normal(random), kSigma_m * normal(random), kSigma_rad * normal(random)});
    }
    node.T_map_base = node.T_odom_base;
    nodes.push_back(node);
  }
  return nodes;
}

PlanarClosure closure(std::uint64_t from, std::uint64_t to, const GroupSe2::Tangent& off = GroupSe2::Tangent::Zero()) {
  PlanarClosure c;
  c.from = from;
  c.to = to;
  c.T_from_to = GroupSe2::plus(truth(from).inverse() * truth(to), off);
  c.covariance = Eigen::Vector3d{0.01, 0.01, 0.002}.cwiseAbs2().asDiagonal();
  return c;
}

double worst_m(const PlanarNodes& nodes) {
  double worst = 0.0;
  for (const PlanarNode& node : nodes) worst = std::max(worst, (node.T_map_base.translation - truth(node.id).translation).norm());
  return worst;
}

TEST(PlanarGraph, ClosuresTakeTheDriftOfTheSecondRound) {
  PlanarNodes nodes = drive(1);
  const double before_m = worst_m(nodes);
  std::vector<PlanarClosure> closures;
  for (std::uint64_t i = 0; i <= kRound; i += 15) closures.push_back(closure(i, i + kRound));
  EXPECT_TRUE(solve_planar_graph(nodes, closures, PlanarGraphConfig{}, SolveLimits{}).usable);
  EXPECT_LT(worst_m(nodes), 0.7 * before_m);
  const PlanarPose rest = nodes[0].T_map_base.inverse() * nodes[kRound].T_map_base;
  EXPECT_LT(rest.translation.norm(), 0.05) << "the round is closed";
  for (const PlanarClosure& c : closures) EXPECT_GT(c.weight, 0.5);
  EXPECT_EQ(nodes.front().T_map_base.translation.norm(), 0.0);
}

TEST(PlanarGraph, WrongClosuresLoseTheirWeightAndBendNothing) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    PlanarNodes clean = drive(seed), mixed = clean;
    std::vector<PlanarClosure> right;
    for (std::uint64_t i = 0; i <= kRound; i += 10) right.push_back(closure(i, i + kRound));
    std::vector<PlanarClosure> both = right;
    both.push_back(closure(5, 70 + kRound, {4.0, -3.0, 0.5}));
    both.push_back(closure(33, 100 + kRound, {-6.0, 2.0, -0.8}));
    solve_planar_graph(clean, right, PlanarGraphConfig{}, SolveLimits{});
    solve_planar_graph(mixed, both, PlanarGraphConfig{}, SolveLimits{});
    EXPECT_LT(both[both.size() - 1].weight, 0.1) << "seed " << seed;
    EXPECT_LT(both[both.size() - 2].weight, 0.1) << "seed " << seed;
    for (std::size_t i = 0; i < clean.size(); ++i) {
      ASSERT_LT((clean[i].T_map_base.translation - mixed[i].T_map_base.translation).norm(), 0.05) << "seed " << seed << ", keyframe " << i;
    }
  }
}

}  // namespace
}  // namespace slamd
