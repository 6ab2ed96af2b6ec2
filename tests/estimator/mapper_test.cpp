// The back end's facade over scripted sources: closures, GPS, gravity, cancelling, snapshots, and the correction of poses.

#include "estimator/graph/mapper.hpp"

#include <gtest/gtest.h>

#include "estimator/graph/correction.hpp"
#include "tests/support/graph_drive.hpp"

namespace slamd {
namespace {

using test::GraphDrive;
using test::ScriptedLoops;
using test::ScriptedPositions;

struct Rig {
  explicit Rig(const GraphDrive& drive, bool with_positions = false) {
    auto l = std::make_unique<ScriptedLoops>();
    auto p = with_positions ? std::make_unique<ScriptedPositions>() : nullptr;
    loops = l.get();
    positions = p.get();
    mapper = std::make_unique<Mapper>(MapperConfig{}, std::move(l), std::move(p));
    for (const Keyframe& keyframe : drive.keyframes) mapper->add(keyframe);
  }

  ScriptedLoops* loops;
  ScriptedPositions* positions;
  std::unique_ptr<Mapper> mapper;
};

/// GPS of every fifth keyframe, map turned by 40 degrees in enu.
EnuAlignment enu_truth() { return {0.7, {120.0, -30.0, 5.0}, Matrix4d::Zero()}; }

std::vector<GnssPosition> positions_of(const GraphDrive& drive, double sigma_m) {
  test::Random random{7};
  std::vector<GnssPosition> out;
  for (std::size_t i = 0; i < drive.truth.size(); i += 5) {
    GnssPosition position;
    position.keyframe = i;
    position.p_keyframe_antenna = {-0.6, 0.35, 1.74};
    position.sigma_m = Eigen::Vector3d::Constant(sigma_m);
    position.p_enu = enu_truth().T_enu_map() * (drive.truth[i] * position.p_keyframe_antenna) + test::normal3(random, sigma_m);
    out.push_back(position);
  }
  return out;
}

TEST(Mapper, WithoutClosuresTheMapIsTheOdometry) {
  const GraphDrive drive{{.keyframes = 40}};
  Rig rig{drive};
  EXPECT_FALSE(rig.mapper->solve());
  EXPECT_EQ(rig.mapper->solution()->changes, 0U);
  for (std::size_t i = 0; i < drive.keyframes.size(); ++i) {
    const Pose& T_odom_base = drive.keyframes[i].state.T_odom_base;
    EXPECT_LT(boxminus(rig.mapper->keyframes()[i].T_map_base, T_odom_base).norm(), 1e-12);
  }
}

TEST(Mapper, ARightClosureAfterALongDriftIsBelieved) {
  const GraphDrive drive{{.keyframes = 301, .keyframes_a_lap = 300, .sigma_m = 0.03, .sigma_rad = 0.003, .seed = 4}};
  Rig rig{drive};
  const double open = test::rmse(rig.mapper->keyframes(), drive.truth);
  ASSERT_GT(open, 1.0);  // fifty sigma of the closure
  rig.loops->now.push_back(drive.closure(0, 300));
  rig.loops->changed = true;
  ASSERT_TRUE(rig.mapper->finish());
  EXPECT_GT(rig.loops->weights.at(0), 0.9);
  EXPECT_LT(test::rmse(rig.mapper->solution()->keyframes, drive.truth), 0.7 * open);
}

TEST(Mapper, BeyondTheByteBudgetNothingIsTakenInAndPosesMoveWithTheLastKeyframe) {
  const GraphDrive drive{{.keyframes = 200}};
  auto loops = std::make_unique<ScriptedLoops>();
  ScriptedLoops* scripted = loops.get();
  MapperConfig config;
  config.byte_budget = 120 * 6'000;
  Mapper mapper{config, std::move(loops), nullptr};
  for (const Keyframe& keyframe : drive.keyframes) mapper.add(keyframe);
  const std::size_t kept = mapper.keyframes().size();
  EXPECT_GT(kept, 110U);
  EXPECT_LT(kept, 190U);
  EXPECT_EQ(mapper.left_out_keyframes(), drive.keyframes.size() - kept);
  EXPECT_LT(mapper.bytes(), mapper.byte_budget() + 6'000);
  scripted->now.push_back(drive.closure(0, 100));
  ASSERT_TRUE(mapper.finish());
  const auto solution = mapper.solution();
  EXPECT_EQ(solution->keyframes.size(), kept);
  const Keyframe& newest = drive.keyframes.back();
  const Pose T_map_base = solution->T_map_odom * newest.state.T_odom_base;
  EXPECT_LT(boxminus(corrected_pose(*solution, newest.state.time, newest.state.T_odom_base), T_map_base).norm(), 1e-9);
}

TEST(Mapper, GravityAloneDoesNotBendOdometry) {
  const GraphDrive drive{{}};
  Rig rig{drive};
  ASSERT_TRUE(rig.mapper->finish());
  std::vector<KeyframeEstimate> odometry(rig.mapper->keyframes().begin(), rig.mapper->keyframes().end());
  for (KeyframeEstimate& keyframe : odometry) keyframe.T_map_base = keyframe.T_odom_base;
  EXPECT_LE(test::rmse(rig.mapper->solution()->keyframes, drive.truth), 1.02 * test::rmse(odometry, drive.truth));
}

/// The filter has learnt where up is by the middle of the drive, and there odometry was unsure of the attitude.
TEST(Mapper, WhatTheFilterHadNotLearntOfGravityDoesNotBendTheMapWhereOdometryIsUnsure) {
  GraphDrive drive{{.sigma_m = 0.0, .sigma_rad = 0.0}};
  const Eigen::Quaterniond tilt = exp_so3({0.012, 0.0, 0.0});
  for (std::size_t i = 0; i < drive.keyframes.size(); ++i) {
    Keyframe& keyframe = drive.keyframes[i];
    keyframe.relative_covariance = test::diagonal6(0.01, i == 100 ? 0.01 : 0.0003);
    if (i >= 100) continue;
    keyframe.up_base = keyframe.state.T_odom_base.rotation.conjugate() * (tilt * Eigen::Vector3d::UnitZ());
    keyframe.up_sigma_rad = 0.015;
  }
  Rig rig{drive};
  ASSERT_TRUE(rig.mapper->finish());
  EXPECT_LT(test::rmse(rig.mapper->solution()->keyframes, drive.truth), 0.02);
}

TEST(Mapper, ClosuresBringTheDriveNearTheTruth) {
  const GraphDrive drive{{}};
  Rig rig{drive};
  const double open = test::rmse(rig.mapper->keyframes(), drive.truth);
  for (std::size_t i = 0; i < 100; i += 10) rig.loops->now.push_back(drive.closure(i, i + 100));
  rig.loops->changed = true;
  ASSERT_TRUE(rig.mapper->solve());
  const auto solution = rig.mapper->solution();
  EXPECT_EQ(solution->changes, 1U);
  EXPECT_EQ(solution->closures, 10U);
  EXPECT_TRUE(solution->converged);
  EXPECT_LT(test::rmse(solution->keyframes, drive.truth), 0.7 * open);
  ASSERT_EQ(rig.loops->weights.size(), 10U);
  for (const double weight : rig.loops->weights) EXPECT_EQ(weight, 1.0);
  const KeyframeEstimate& newest = solution->keyframes.back();
  EXPECT_LT(boxminus(solution->T_map_odom * newest.T_odom_base, newest.T_map_base).norm(), 1e-9);
}

TEST(Mapper, AWrongClosureAmongRightOnesIsWeighedDownAndItsRemovalUndoesIt) {
  const GraphDrive drive{{}};
  Rig clean{drive};
  Rig rig{drive};
  for (std::size_t i = 0; i < 100; i += 10) clean.loops->now.push_back(drive.closure(i, i + 100));
  rig.loops->now = clean.loops->now;
  rig.loops->now.push_back(drive.closure(30, 150, {exp_so3({0.0, 0.0, 0.5}), {20.0, 3.0, 0.0}}));
  ASSERT_TRUE(clean.mapper->finish());
  ASSERT_TRUE(rig.mapper->finish());
  EXPECT_LT(rig.loops->weights.back(), 0.01);
  const double clean_rmse = test::rmse(clean.mapper->solution()->keyframes, drive.truth);
  EXPECT_LT(test::rmse(rig.mapper->solution()->keyframes, drive.truth), 1.5 * clean_rmse + 0.02);
  rig.loops->now.pop_back();
  rig.loops->changed = true;
  EXPECT_FALSE(rig.mapper->solve());  // the drive has not grown since
  ASSERT_TRUE(rig.mapper->finish());
  EXPECT_NEAR(test::rmse(rig.mapper->solution()->keyframes, drive.truth), clean_rmse, 1e-3);
}

TEST(Mapper, GpsAlignsTheMapInEnuWithATrueCovariance) {
  const GraphDrive drive{{}};
  Rig rig{drive, true};
  rig.positions->now = positions_of(drive, 0.5);
  EnuAlignment start = enu_truth();
  start.yaw_rad += 0.1;
  start.translation += Eigen::Vector3d{3.0, -2.0, 1.0};
  rig.positions->start = start;
  rig.positions->changed = true;
  ASSERT_TRUE(rig.mapper->solve());
  const auto solution = rig.mapper->solution();
  ASSERT_TRUE(solution->enu_valid);
  EXPECT_EQ(solution->enu_origin.latitude_deg, 50.0);
  EXPECT_EQ(solution->positions, rig.positions->now.size());
  Eigen::Vector4d error;
  error << solution->enu.translation - enu_truth().translation, solution->enu.yaw_rad - enu_truth().yaw_rad;
  const double nees = error.dot(solution->enu.covariance.inverse() * error);
  EXPECT_LT(nees, 18.5);  // 99.9 % of 4 degrees of freedom
  EXPECT_LT(std::sqrt(solution->enu.covariance(0, 0)), 0.5);
  EXPECT_GT(std::sqrt(solution->enu.covariance(0, 0)), 0.02);
}

TEST(Mapper, GpsThatJumps30MetresForAWhileDoesNotBendTheMap) {
  const GraphDrive drive{{}};
  Rig clean{drive, true};
  Rig rig{drive, true};
  for (Rig* r : {&clean, &rig}) {
    r->positions->now = positions_of(drive, 0.5);
    r->positions->start = enu_truth();
  }
  for (std::size_t i = 15; i < 22; ++i) rig.positions->now[i].p_enu += Eigen::Vector3d{25.0, -17.0, 0.0};
  ASSERT_TRUE(clean.mapper->finish());
  ASSERT_TRUE(rig.mapper->finish());
  for (std::size_t i = 15; i < 22; ++i) EXPECT_LT(rig.positions->weights[i], 0.01);
  EXPECT_LT(test::rmse(rig.mapper->solution()->keyframes, drive.truth),
            1.1 * test::rmse(clean.mapper->solution()->keyframes, drive.truth));
}

TEST(Mapper, ACancelledSolvePublishesNothingAndTheNextOneGoesOn) {
  const GraphDrive drive{{}};
  Rig rig{drive};
  rig.loops->now.push_back(drive.closure(0, 199));
  rig.loops->changed = true;
  const auto before = rig.mapper->solution();
  EXPECT_FALSE(rig.mapper->solve([] { return true; }));
  EXPECT_EQ(rig.mapper->solution(), before);
  EXPECT_TRUE(rig.mapper->solve());
  EXPECT_EQ(rig.mapper->solution()->changes, 1U);
  EXPECT_EQ(before->changes, 0U);
}

TEST(Mapper, TwoRunsGiveTheSameBits) {
  const GraphDrive drive{{}};
  Rig a{drive};
  Rig b{drive};
  for (Rig* rig : {&a, &b}) {
    rig->loops->now.push_back(drive.closure(5, 105));
    rig->mapper->finish();
  }
  for (std::size_t i = 0; i < drive.truth.size(); ++i) {
    EXPECT_EQ(a.mapper->keyframes()[i].T_map_base.translation, b.mapper->keyframes()[i].T_map_base.translation);
  }
}

TEST(Mapper, KeyframesOutOfOrderOrNotFiniteAreRefusedAndCounted) {
  GraphDrive drive{{.keyframes = 3}};
  Mapper mapper{{}, nullptr, nullptr};
  mapper.add(drive.keyframes[0]);
  mapper.add(drive.keyframes[2]);
  drive.keyframes[1].state.T_odom_base.translation.x() = std::nan("");
  mapper.add(drive.keyframes[1]);
  EXPECT_EQ(mapper.rejected_keyframes(), 2U);
  EXPECT_EQ(mapper.keyframes().size(), 1U);
}

TEST(Mapper, WithoutKeyframesThereIsNothingToSolve) {
  Mapper mapper{{}, nullptr, nullptr};
  EXPECT_FALSE(mapper.solve());
  EXPECT_FALSE(mapper.finish());
  EXPECT_TRUE(mapper.solution()->keyframes.empty());
}

TEST(Mapper, OdometryThatBeganAnewIsChainedOn) {
  const GraphDrive drive{{.keyframes = 60}};
  Mapper mapper{{}, nullptr, nullptr};
  for (Keyframe keyframe : drive.keyframes) {
    if (keyframe.id >= 30) keyframe.state.T_odom_base.translation.x() += 500.0;
    if (keyframe.id == 30) keyframe.relative_covariance = 1e6 * Matrix6d::Identity();
    mapper.add(keyframe);
  }
  EXPECT_TRUE(mapper.finish());
  for (const KeyframeEstimate& keyframe : mapper.keyframes()) EXPECT_TRUE(keyframe.T_map_base.translation.allFinite());
}

TEST(CorrectedPose, PassesThroughTheKeyframesAndHasNoStepBetweenThem) {
  const GraphDrive drive{{}};
  Rig rig{drive};
  rig.loops->now.push_back(drive.closure(0, 100, {Eigen::Quaterniond::Identity(), {0.5, 0.5, 0.0}}));
  ASSERT_TRUE(rig.mapper->finish());
  const GraphSolution& solution = *rig.mapper->solution();
  Pose previous;
  for (std::size_t i = 0; i + 1 < solution.keyframes.size(); ++i) {
    const KeyframeEstimate& a = solution.keyframes[i];
    const KeyframeEstimate& b = solution.keyframes[i + 1];
    EXPECT_LT(boxminus(corrected_pose(solution, a.time, a.T_odom_base), a.T_map_base).norm(), 1e-9);
    for (int k = 0; k < 50; ++k) {
      const Pose T_odom_base = interpolate(a.T_odom_base, b.T_odom_base, k / 50.0);
      const Pose T_map_base = corrected_pose(solution, a.time + k * (b.time - a.time) / 50, T_odom_base);
      const double moved_m = (T_map_base.translation - previous.translation).norm();
      EXPECT_LT(moved_m, 0.04);
      previous = T_map_base;
    }
  }
}

TEST(CorrectedPose, OutsideTheKeyframesTheNearestOneHolds) {
  const GraphDrive drive{{.keyframes = 100}};
  Rig rig{drive};
  ASSERT_TRUE(rig.mapper->finish());
  const GraphSolution& solution = *rig.mapper->solution();
  const Pose ahead{Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0}};
  const KeyframeEstimate& last = solution.keyframes.back();
  const Pose T = corrected_pose(solution, last.time + std::chrono::seconds{5}, last.T_odom_base * ahead);
  EXPECT_LT(boxminus(T, last.T_map_base * ahead).norm(), 1e-9);
  const KeyframeEstimate& first = solution.keyframes.front();
  const Pose before = corrected_pose(solution, first.time - std::chrono::seconds{5}, first.T_odom_base * ahead);
  EXPECT_LT(boxminus(before, first.T_map_base * ahead).norm(), 1e-9);
}

}  // namespace
}  // namespace slamd
