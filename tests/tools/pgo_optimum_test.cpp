// The public pose graphs against their known optima, from edges alone.

#include <gtest/gtest.h>

#include <fstream>

#include "estimator/graph/chordal.hpp"
#include "tests/support/shared_data.hpp"
#include "tools/slam-pgo/g2o_file.hpp"
#include "tools/slam-pgo/objective.hpp"

namespace slamd::pgo {
namespace {

/// Values of shared/data/g2o/README.md: SE-Sync objectives.
struct Reference {
  const char* name;
  double chordal;
  double optimum;
};

void PrintTo(const Reference& reference, std::ostream* out) { *out << reference.name; }

class PublicGraphs : public testing::TestWithParam<Reference> {};

template <class Group>
void expect_optimum(const G2oGraph<Group>& g2o, const Reference& reference) {
  PoseGraph<Group> graph = sesync(g2o.graph);
  anchor_parts(graph);
  for (auto& pose : graph.poses) pose = {};  // nothing of the file's own poses may help
  ASSERT_TRUE(initialise_chordal(graph));
  EXPECT_NEAR(objective(graph), reference.chordal, 1e-3 * reference.chordal);
  SolveLimits limits;
  limits.relative_tolerance = 1e-9;
  const SolveOutcome outcome = solve(graph, limits);
  EXPECT_TRUE(outcome.converged);
  EXPECT_NEAR(objective(graph), outcome.objective, 1e-6 * outcome.objective);
  EXPECT_NEAR(objective(graph), reference.optimum, 1e-4 * reference.optimum);
}

TEST_P(PublicGraphs, ChordalInitialisationAndOptimumAreThoseOfTheReference) {
  const std::string path = test::shared_data("g2o/" + std::string{GetParam().name} + ".g2o");
  if (!test::is_there(path)) GTEST_SKIP() << "shared data is absent: " << path;
  std::ifstream in{path};
  const auto read = read_g2o(in);
  ASSERT_TRUE(std::holds_alternative<AnyGraph>(read));
  std::visit([](const auto& g2o) { expect_optimum(g2o, GetParam()); }, std::get<AnyGraph>(read));
}

INSTANTIATE_TEST_SUITE_P(Reference, PublicGraphs,
                         testing::Values(Reference{"sphere2500", 1971.18, 1687.0058},
                                         Reference{"parking-garage", 1.41536, 1.2625244},
                                         Reference{"smallGrid3D", 1561.38, 1025.3981},
                                         Reference{"manhattan", 6438.21, 6431.3914},
                                         Reference{"intel", 53.3949, 52.348227},
                                         Reference{"kitti_05", 280.6, 276.51438}));

TEST(AnchorParts, FixesOnePoseOfEachPartThatHasNone) {
  PoseGraph<GroupSe2> graph;
  graph.poses.resize(6);
  graph.fixed = {false, true, false, false, false, false};
  const auto edge = [](std::size_t a, std::size_t b) { return Edge<GroupSe2>{a, b, {}, Eigen::Matrix3d::Identity()}; };
  graph.edges = {edge(0, 1), edge(3, 2)};  // 4 and 5 stand alone
  EXPECT_EQ(anchor_parts(graph), 3U);
  EXPECT_EQ(graph.fixed, (std::vector<bool>{false, true, true, false, true, true}));
}

TEST(Chordal, KeepsSeveralFixedPosesAndFitsTheRestBetween) {
  PoseGraph<GroupSe2> graph;
  graph.poses = {{{0.0, 0.0}, 0.0}, {}, {{2.2, 0.0}, 0.0}};
  graph.fixed = {true, false, true};
  graph.edges = {{0, 1, {{1.0, 0.0}, 0.0}, Eigen::Matrix3d::Identity()},
                 {1, 2, {{1.0, 0.0}, 0.0}, Eigen::Matrix3d::Identity()}};
  ASSERT_TRUE(initialise_chordal(graph));
  EXPECT_NEAR(graph.poses[1].translation.x(), 1.1, 1e-12);
  EXPECT_EQ(graph.poses[2].translation.x(), 2.2);
}

TEST(Chordal, SaysSoWhenAPartHasNoFixedPose) {
  PoseGraph<GroupSe2> graph;
  graph.poses.resize(2);
  graph.fixed = {false, false};
  graph.edges = {{0, 1, {{1.0, 0.0}, 0.0}, Eigen::Matrix3d::Identity()}};
  EXPECT_FALSE(initialise_chordal(graph));
}

}  // namespace
}  // namespace slamd::pgo
