// Laws of the metrics on made-up trajectories; the comparison with evo is in eval_evo_test.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tools/slam-eval/alignment.hpp"
#include "tools/slam-eval/metrics.hpp"
#include "tools/slam-eval/trajectory.hpp"

namespace slamd::eval {
namespace {

Pose pose(double x, double y, double z, double yaw_rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())), {x, y, z}};
}

std::vector<Pose> random_drive(std::size_t count) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    poses.push_back({q.normalized(), {normal(random), normal(random), normal(random)}});
  }
  return poses;
}

std::vector<Pose> straight(const std::vector<double>& xs) {
  std::vector<Pose> poses;
  for (const double x : xs) poses.push_back(pose(x, 0, 0, 0));
  return poses;
}

using Pairs = std::vector<PosePair>;

TEST(Statistics, of_a_known_list) {
  const Statistics s = statistics({3.0, 1.0, 2.0, 4.0});
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.sse, 30.0);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(s.min, 1.0);
  EXPECT_DOUBLE_EQ(s.max, 4.0);
  EXPECT_DOUBLE_EQ(statistics({5.0, 1.0, 9.0}).median, 5.0);
  EXPECT_EQ(statistics({}).count, 0U);
}

TEST(Alignment, removes_any_rigid_motion) {
  const auto truth = random_drive(50);
  const Pose moved = pose(10, -20, 3, 2.1) * random_drive(1).front();
  std::vector<Pose> estimate;
  for (const Pose& p : truth) estimate.push_back(moved * p);
  const auto back = aligned(fit(Alignment::kSe3Umeyama, truth, estimate), estimate);
  EXPECT_LT(statistics(ape(truth, back, PoseRelation::kFullTransformation)).max, 1e-12);
  const auto origin = aligned(fit(Alignment::kOrigin, truth, estimate), estimate);
  EXPECT_LT(statistics(ape(truth, origin, PoseRelation::kFullTransformation)).max, 1e-12);
}

TEST(Alignment, with_scale_finds_the_scale_and_without_keeps_it) {
  const auto truth = random_drive(30);
  auto estimate = truth;
  for (Pose& p : estimate) p.translation *= 0.5;
  EXPECT_NEAR(fit(Alignment::kSim3Umeyama, truth, estimate).scale, 2.0, 1e-12);
  EXPECT_EQ(fit(Alignment::kSe3Umeyama, truth, estimate).scale, 1.0);
}

TEST(Alignment, never_mirrors) {
  auto truth = random_drive(30);
  auto estimate = truth;
  for (Pose& p : estimate) p.translation.z() *= -1.0;
  const auto T = fit(Alignment::kSe3Umeyama, truth, estimate).T_truth_estimate;
  EXPECT_NEAR(T.rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
}

TEST(Alignment, uses_only_the_first_poses_when_told) {
  const auto truth = random_drive(20);
  auto estimate = truth;
  for (std::size_t i = 10; i < 20; ++i) estimate[i].translation.x() += 5.0;
  const auto T = fit(Alignment::kSe3Umeyama, truth, estimate, 10).T_truth_estimate;
  EXPECT_LT(T.translation.norm(), 1e-12);
}

TEST(Alignment, refuses_positions_that_fix_no_rotation) {
  EXPECT_THROW(fit(Alignment::kSe3Umeyama, straight({0, 1, 2, 3}), straight({0, 1, 2, 3})), InputError);
  EXPECT_THROW(fit(Alignment::kSe3Umeyama, straight({1, 1}), straight({1, 1})), InputError);
}

TEST(Relations, of_one_known_error) {
  const std::vector<Pose> truth{pose(0, 0, 0, 0)};
  const std::vector<Pose> estimate{pose(3, 4, 0, std::numbers::pi / 3)};
  const auto value = [&](PoseRelation r) { return ape(truth, estimate, r).front(); };
  EXPECT_NEAR(value(PoseRelation::kTranslationPart), 5.0, 1e-12);
  EXPECT_NEAR(value(PoseRelation::kPointDistance), 5.0, 1e-12);
  EXPECT_NEAR(value(PoseRelation::kRotationAngleDeg), 60.0, 1e-12);
  EXPECT_NEAR(value(PoseRelation::kRotationAngleRad), std::numbers::pi / 3, 1e-12);
  EXPECT_NEAR(value(PoseRelation::kRotationPart), std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(value(PoseRelation::kFullTransformation), std::sqrt(27.0), 1e-12);
}

TEST(Relations, resolve_tiny_and_half_turn_angles) {
  const auto angle = [](double rad) {
    return ape({pose(0, 0, 0, 0)}, {pose(0, 0, 0, rad)}, PoseRelation::kRotationAngleRad).front();
  };
  EXPECT_NEAR(angle(1e-9), 1e-9, 1e-15);
  EXPECT_NEAR(angle(std::numbers::pi), std::numbers::pi, 1e-12);
}

TEST(Rpe, does_not_see_a_common_motion_and_sees_each_step) {
  const auto truth = random_drive(20);
  std::vector<Pose> estimate;
  for (const Pose& p : truth) estimate.push_back(pose(5, 6, 7, 1.0) * p);
  const auto pairs = pose_pairs(estimate, {});
  EXPECT_LT(statistics(rpe(truth, estimate, pairs, PoseRelation::kFullTransformation)).max, 1e-12);
  const auto steps = rpe(straight({0, 1, 2}), straight({0, 1.5, 2.5}), {{0, 1}, {1, 2}}, PoseRelation::kTranslationPart);
  EXPECT_NEAR(steps[0], 0.5, 1e-12);
  EXPECT_NEAR(steps[1], 0.0, 1e-12);
}

TEST(Pairs, by_frames) {
  const auto poses = straight({0, 1, 2, 3, 4});
  EXPECT_EQ(pose_pairs(poses, {.delta = 2}), (Pairs{{0, 2}, {2, 4}}));
  EXPECT_EQ(pose_pairs(poses, {.delta = 2, .all_pairs = true}), (Pairs{{0, 2}, {1, 3}, {2, 4}}));
  EXPECT_TRUE(pose_pairs(poses, {.delta = 5}).empty());
}

TEST(Pairs, by_metres_follow_the_path_not_the_crow) {
  const auto there_and_back = straight({0.0, 0.6, 1.2, 0.6, 0.0, -0.6, -1.2});
  const RpeOptions metre{.delta = 1.0, .unit = DeltaUnit::kMetres};
  EXPECT_EQ(pose_pairs(there_and_back, metre), (Pairs{{2, 4}, {4, 6}}));
  const RpeOptions all{.delta = 1.2, .unit = DeltaUnit::kMetres, .all_pairs = true};
  EXPECT_EQ(pose_pairs(there_and_back, all), (Pairs{{0, 2}, {1, 3}, {2, 4}, {3, 5}, {4, 6}}));
}

TEST(Pairs, by_metres_take_the_first_of_equally_good_partners_and_respect_the_tolerance) {
  const auto standing = straight({0.0, 1.0, 1.0, 1.0, 2.5});
  const RpeOptions all{.delta = 1.0, .unit = DeltaUnit::kMetres, .all_pairs = true};
  EXPECT_EQ(pose_pairs(standing, all), (Pairs{{0, 1}}));
  const RpeOptions loose{.delta = 1.0, .unit = DeltaUnit::kMetres, .all_pairs = true, .relative_tolerance = 0.5};
  EXPECT_EQ(pose_pairs(standing, loose), (Pairs{{0, 1}, {1, 4}, {2, 4}, {3, 4}}));
}

TEST(Pairs, by_degrees) {
  std::vector<Pose> turning;
  for (int i = 0; i <= 6; ++i) turning.push_back(pose(0, 0, 0, i * 10.0 * std::numbers::pi / 180.0));
  EXPECT_EQ(pose_pairs(turning, {.delta = 19.9, .unit = DeltaUnit::kDegrees}), (Pairs{{0, 2}, {2, 4}, {4, 6}}));
  EXPECT_EQ(pose_pairs(turning, {.delta = 50, .unit = DeltaUnit::kDegrees, .all_pairs = true}), (Pairs{{0, 5}, {1, 6}}));
}

TEST(Pairs, refuse_a_delta_that_means_nothing) {
  const auto poses = straight({0, 1});
  EXPECT_THROW(pose_pairs(poses, {.delta = 0.0}), InputError);
  EXPECT_THROW(pose_pairs(poses, {.delta = -1.0, .unit = DeltaUnit::kMetres}), InputError);
  EXPECT_THROW(pose_pairs(poses, {.delta = 1.5}), InputError);
  EXPECT_THROW(pose_pairs(poses, {.delta = std::nan("")}), InputError);
}

}  // namespace
}  // namespace slamd::eval
