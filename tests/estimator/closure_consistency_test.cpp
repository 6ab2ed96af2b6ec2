#include "estimator/graph/closure_consistency.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using test::Random;

/// 60 keyframes straight ahead, a metre apart, the first 30 and the last 30 on top of each other after a jump back.
struct TwoVisits {
  OdometryChain chain;
  std::vector<Pose> truth;

  explicit TwoVisits(std::uint64_t seed) {
    Random random{seed};
    Pose T_odom_base;
    for (std::size_t i = 0; i < 60; ++i) {
      truth.push_back({Eigen::Quaterniond::Identity(), {static_cast<double>(i % 30), 0.1 * static_cast<double>(i / 30), 0.0}});
      if (i > 0) T_odom_base = T_odom_base * boxplus(truth[i - 1].inverse() * truth[i], noise(random, 0.02, 0.001));
      chain.add(T_odom_base, covariance(0.02, 0.001));
    }
  }

  static Matrix6d covariance(double sigma_m, double sigma_rad) {
    Vector6d variances;
    variances << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
    return variances.asDiagonal();
  }
  static Vector6d noise(Random& random, double sigma_m, double sigma_rad) {
    Vector6d e;
    for (int i = 0; i < 6; ++i) e[i] = test::normal(random, i < 3 ? sigma_m : sigma_rad);
    return e;
  }
  LoopClosure closure(std::size_t i, Random& random, const Eigen::Vector3d& wrong_by = Eigen::Vector3d::Zero()) const {
    Pose T = boxplus(truth[i].inverse() * truth[i + 30], noise(random, 0.01, 0.001));
    T.translation += wrong_by;
    return {i, i + 30, T, covariance(0.01, 0.001)};
  }
};

TEST(ClosureConsistency, DistancesOfTrueClosuresFollowChiSquaredOfSixDegreesOfFreedom) {
  Random random{7};
  double odometry = 0.0;
  double ring = 0.0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    const TwoVisits visits{static_cast<std::uint64_t>(run) + 1};
    const LoopClosure a = visits.closure(3, random);
    odometry += odometry_distance2(visits.chain, a) / kRuns;
    ring += ring_distance2(visits.chain, a, visits.closure(25, random)) / kRuns;
  }
  const double bound = 3.0 * std::sqrt(2.0 * 6.0 / kRuns);
  EXPECT_NEAR(odometry, 6.0, bound + 0.1);
  EXPECT_NEAR(ring, 6.0, bound + 0.1);
}

TEST(ClosureConsistency, AWrongClosureDisagreesWithTrueOnes) {
  Random random{3};
  const TwoVisits visits{11};
  const LoopClosure good = visits.closure(5, random);
  const LoopClosure wrong = visits.closure(8, random, {1.0, 0.0, 0.0});
  EXPECT_GT(ring_distance2(visits.chain, good, wrong), 22.46);
  EXPECT_LT(ring_distance2(visits.chain, good, visits.closure(9, random)), 22.46);
}

TEST(ClosureConsistency, TheOrderOfAPairDoesNotMatter) {
  Random random{5};
  const TwoVisits visits{2};
  const LoopClosure a = visits.closure(2, random);
  const LoopClosure b = visits.closure(20, random);
  EXPECT_NEAR(ring_distance2(visits.chain, a, b), ring_distance2(visits.chain, b, a), 0.05);
}

/// Size of the largest clique by trying all sets.
std::size_t largest_by_enumeration(const std::vector<std::vector<bool>>& adjacent) {
  std::size_t best = 0;
  for (std::uint32_t set = 1; set < 1U << adjacent.size(); ++set) {
    bool clique = true;
    for (std::size_t i = 0; i < adjacent.size() && clique; ++i) {
      for (std::size_t j = 0; j < i && clique; ++j) {
        clique = !(set >> i & 1U) || !(set >> j & 1U) || adjacent[i][j];
      }
    }
    if (clique) best = std::max(best, static_cast<std::size_t>(__builtin_popcount(set)));
  }
  return best;
}

TEST(AgreementGraph, FindsTheLargestCliqueOfRandomGraphsAsEnumerationDoes) {
  Random random{17};
  for (int run = 0; run < 60; ++run) {
    const double density = test::uniform(random, 0.2, 0.9);
    AgreementGraph graph;
    std::vector<std::vector<bool>> adjacent(13, std::vector<bool>(13, false));
    for (std::size_t node = 0; node < adjacent.size(); ++node) {
      std::vector<std::size_t> agrees_with;
      for (std::size_t other = 0; other < node; ++other) {
        if (test::uniform(random, 0.0, 1.0) > density) continue;
        agrees_with.push_back(other);
        adjacent[node][other] = adjacent[other][node] = true;
      }
      graph.add(agrees_with);
    }
    const std::vector<std::size_t>& clique = graph.largest_clique();
    EXPECT_EQ(clique.size(), largest_by_enumeration(adjacent));
    for (const std::size_t a : clique) {
      for (const std::size_t b : clique) EXPECT_TRUE(a == b || adjacent[a][b]);
    }
  }
}

TEST(AgreementGraph, AMinorityThatCameFirstIsOutvoted) {
  AgreementGraph graph;
  graph.add({});
  graph.add({0});         // two that are wrong together
  graph.add({});
  graph.add({2});
  EXPECT_EQ(graph.largest_clique().size(), 2U);
  graph.add({2, 3});
  std::vector<std::size_t> clique = graph.largest_clique();
  std::ranges::sort(clique);
  EXPECT_EQ(clique, (std::vector<std::size_t>{2, 3, 4}));
}

}  // namespace
}  // namespace slamd
