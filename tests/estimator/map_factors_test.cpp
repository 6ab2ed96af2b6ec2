// Gravity and GNSS factors, losses and marginal covariances of the map's graph.

#include <ceres/problem.h>
#include <gtest/gtest.h>

#include "estimator/graph/gnss_factor.hpp"
#include "estimator/graph/gravity_factor.hpp"
#include "estimator/graph/marginal.hpp"
#include "estimator/graph/minimise.hpp"
#include "estimator/graph/pose_graph.hpp"
#include "estimator/graph/robust_loss.hpp"
#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using test::Random;

TEST(GravityFactor, JacobianIsThatOfFiniteDifferences) {
  Random random{1};
  for (int i = 0; i < 20; ++i) {
    const GravityFactor factor{test::unit3(random), 0.01};
    test::expect_jacobians(factor, {test::variable<GroupSe3>(test::random_pose(random))});
  }
}

TEST(GravityFactor, IsZeroWhenUpIsUpWhateverTheYawAndGrowsWithTheTilt) {
  Random random{2};
  const Pose T_map_base = test::random_pose(random);
  const Eigen::Vector3d up_base = T_map_base.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const GravityFactor factor{up_base, 0.01};
  EXPECT_LT(test::residual_of(factor, {test::variable<GroupSe3>(T_map_base)}).norm(), 1e-12);
  const Pose turned = Pose{exp_so3({0.0, 0.0, 1.3}), {1.0, 2.0, 3.0}} * T_map_base;
  EXPECT_LT(test::residual_of(factor, {test::variable<GroupSe3>(turned)}).norm(), 1e-12);
  const Pose tilted = Pose{exp_so3({0.005, 0.0, 0.0}), Eigen::Vector3d::Zero()} * T_map_base;
  EXPECT_NEAR(test::residual_of(factor, {test::variable<GroupSe3>(tilted)}).norm(), 0.5, 1e-4);
}

TEST(GnssFactor, JacobiansAreThoseOfFiniteDifferences) {
  Random random{3};
  for (int i = 0; i < 20; ++i) {
    const GnssPosition position{0, test::normal3(random, 2.0), test::normal3(random, 100.0), {1.0, 2.0, 3.0}};
    test::expect_jacobians(GnssFactor{position}, {test::variable<GroupSe3>(test::random_pose(random, 50.0)),
                                                  test::additive({10.0, -20.0, 3.0, test::uniform(random, -3.0, 3.0)})});
  }
}

TEST(GnssFactor, IsZeroWhereTheAntennaIs) {
  Random random{4};
  const Pose T_map_base = test::random_pose(random, 50.0);
  const EnuAlignment enu{0.7, {100.0, 200.0, 300.0}, Matrix4d::Zero()};
  GnssPosition position;
  position.p_keyframe_antenna = {-0.6, 0.35, 1.74};
  position.p_enu = enu.T_enu_map() * (T_map_base * position.p_keyframe_antenna);
  std::vector<double> block(EnuBlock::kSize);
  EnuBlock::store(enu, block.data());
  const GnssFactor factor{position};
  EXPECT_LT(test::residual_of(factor, {test::variable<GroupSe3>(T_map_base), test::additive(block)}).norm(), 1e-9);
}

TEST(DcsLoss, IsQuadraticUpToPhiAndBoundedBeyond) {
  const DcsLoss loss{4.0};
  double rho[3];
  loss.Evaluate(3.9, rho);
  EXPECT_DOUBLE_EQ(rho[0], 3.9);
  EXPECT_DOUBLE_EQ(rho[1], 1.0);
  loss.Evaluate(1e12, rho);
  EXPECT_NEAR(rho[0], 12.0, 1e-6);
  EXPECT_LT(rho[1], 1e-20);
}

TEST(DcsLoss, DerivativesAreThoseOfFiniteDifferencesAndTheWeightIsTheSquareOfAgarwalsScale) {
  const DcsLoss loss{4.0};
  for (const double s : {1.0, 4.1, 10.0, 300.0}) {
    double rho[3], ahead[3], behind[3];
    loss.Evaluate(s, rho);
    loss.Evaluate(s + 1e-4, ahead);
    loss.Evaluate(s - 1e-4, behind);
    EXPECT_NEAR(rho[1], (ahead[0] - behind[0]) / 2e-4, 1e-6);
    EXPECT_NEAR(rho[2], (ahead[1] - behind[1]) / 2e-4, 1e-6);
    const double scale = std::min(1.0, 2.0 * 4.0 / (4.0 + s));
    EXPECT_NEAR(loss.weight(s), scale * scale, 1e-12);
  }
}

TEST(MarginalCovariance, OfAChainIsTheSumOfItsSteps) {
  const Matrix6d covariance = 0.01 * Matrix6d::Identity();
  std::vector<Pose> poses(3);
  GraphProblem<GroupSe3> problem{poses, {true, false, false}};
  problem.add({0, 1, Pose{}, covariance.inverse()}, RotationError::kLog);
  problem.add({1, 2, Pose{}, covariance.inverse()}, RotationError::kLog);
  const Eigen::MatrixXd marginal = marginal_covariance(problem.problem(), problem.block(2));
  ASSERT_EQ(marginal.rows(), 6);
  EXPECT_TRUE(marginal.isApprox(2.0 * covariance, 1e-9));
}

TEST(MarginalCovariance, OfWhatNothingConstrainsIsEmpty) {
  std::vector<Pose> poses(2);
  GraphProblem<GroupSe3> problem{poses, {false, false}};
  problem.add({0, 1, Pose{}, Matrix6d::Identity()}, RotationError::kLog);
  EXPECT_EQ(marginal_covariance(problem.problem(), problem.block(1)).rows(), 0);
}

TEST(ErrorCosts, AreWhatASolveWithAndWithoutTheErrorSays) {
  const Matrix6d information = 100.0 * Matrix6d::Identity();
  Pose ahead;
  ahead.translation.x() = 1.0;
  Pose too_far;
  too_far.translation.x() = 2.3;
  std::vector<Pose> poses{{}, ahead, ahead * ahead};
  const std::vector<bool> fixed{true, false, false};
  GraphProblem<GroupSe3> problem{poses, fixed};
  std::vector<ceres::ResidualBlockId> chain{problem.add({0, 1, ahead, information}, RotationError::kLog),
                                            problem.add({1, 2, ahead, information}, RotationError::kLog)};
  const ceres::ResidualBlockId loop = problem.add({0, 2, too_far, information}, RotationError::kLog);
  const std::vector<double> to_add = error_costs(problem.problem(), chain, {loop}, ErrorsAre::kLeftOut);
  const SolveOutcome outcome = minimise(problem.problem(), {});
  chain.push_back(loop);
  const std::vector<double> to_leave = error_costs(problem.problem(), chain, {loop}, ErrorsAre::kSolvedWith);
  ASSERT_EQ(to_add.size(), 1U);
  ASSERT_EQ(to_leave.size(), 1U);
  EXPECT_NEAR(outcome.objective, 3.0, 1e-6);  // 0.3 m over three edges of 0.1 m
  EXPECT_NEAR(to_add[0], outcome.objective, 1e-6);
  EXPECT_NEAR(to_leave[0], outcome.objective, 1e-6);
}

TEST(ErrorCosts, AnErrorThatAloneHoldsAPoseCostsNothing) {
  std::vector<Pose> poses(2);
  GraphProblem<GroupSe3> problem{poses, {true, false}};
  const ceres::ResidualBlockId only = problem.add({0, 1, Pose{}, Matrix6d::Identity()}, RotationError::kLog);
  EXPECT_EQ(error_costs(problem.problem(), {only}, {only}, ErrorsAre::kSolvedWith), std::vector<double>{0.0});
}

}  // namespace
}  // namespace slamd
