// Graphs that files of others contain: rotations that nobody measured, ids with gaps, a second edge between neighbours.

#include <gtest/gtest.h>

#include "estimator/graph/chordal.hpp"
#include "estimator/graph/gnc.hpp"
#include "estimator/graph/group_se2.hpp"
#include "estimator/graph/group_se3.hpp"
#include "tools/slam-pgo/loops.hpp"

namespace slamd::pgo {
namespace {

/// A helix of so many poses, a step a metre, and every edge as the truth has it.
PoseGraph<GroupSe3> helix(std::size_t count) {
  const Pose step{Eigen::Quaterniond{Eigen::AngleAxisd{0.2, Eigen::Vector3d{0.1, 0.0, 1.0}.normalized()}}, {1.0, 0.0, 0.1}};
  PoseGraph<GroupSe3> graph;
  graph.poses.resize(count);
  for (std::size_t i = 1; i < count; ++i) {
    graph.poses[i] = graph.poses[i - 1] * step;
    graph.edges.push_back({i - 1, i, step, GroupSe3::Matrix::Identity()});
  }
  graph.fixed.assign(count, false);
  graph.fixed[0] = true;
  return graph;
}

TEST(OddGraphs, AnEdgeThatKnowsNoRotationHoldsTheTranslationAlone) {
  PoseGraph<GroupSe3> graph = helix(60);
  for (std::size_t i = 0; i + 30 < 60; ++i) {
    Edge<GroupSe3> edge{i, i + 30, graph.poses[i].inverse() * graph.poses[i + 30], GroupSe3::Matrix::Zero()};
    edge.measured.rotation = Eigen::Quaterniond::UnitRandom();  // says nothing, and must not be heard
    edge.information.topLeftCorner<3, 3>().setIdentity();
    graph.edges.push_back(edge);
  }
  const std::vector<Pose> truth = graph.poses;
  for (std::size_t i = 1; i < truth.size(); ++i) graph.poses[i] = {};
  ASSERT_TRUE(initialise_chordal(graph));
  const SolveOutcome outcome = solve(graph, {});
  EXPECT_LT(outcome.objective, 1e-8);
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_LT((graph.poses[i].translation - truth[i].translation).norm(), 1e-4);
}

TEST(OddGraphs, APoseWhoseRotationNobodyMeasuredIsStillPlaced) {
  PoseGraph<GroupSe3> graph = helix(10);
  graph.edges.back().information.bottomRightCorner<3, 3>().setZero();
  const Eigen::Vector3d truth = graph.poses.back().translation;
  graph.poses.back() = {};
  ASSERT_TRUE(initialise_chordal(graph));
  EXPECT_LT(solve(graph, {}).objective, 1e-8);
  EXPECT_LT((graph.poses.back().translation - truth).norm(), 1e-4);
}

TEST(OddGraphs, OnlyTheFirstEdgeBetweenNeighboursIsOdometry) {
  PoseGraph<GroupSe2> graph;
  graph.poses.resize(4);
  for (const auto& [from, to] : {std::pair{0, 1}, {2, 1}, {1, 2}, {2, 3}, {3, 0}, {1, 3}})
    graph.edges.push_back({static_cast<std::size_t>(from), static_cast<std::size_t>(to), {}, GroupSe2::Matrix::Identity()});
  EXPECT_EQ(loops_of(graph), (std::vector<bool>{false, false, true, false, true, true}));
}

}  // namespace
}  // namespace slamd::pgo
