// Distances to lines against finite differences, poses in rooms against the truth, and the covariance against the errors made.
#include "estimator/grid/line_matcher.hpp"

#include <gtest/gtest.h>

#include <random>

namespace slamd {
namespace {

/// A wall from a to b, seen from its left side.
struct Wall {
  Eigen::Vector2d a, b;
};
const std::vector<Wall> kRoom{{{-4, -3}, {5, -3}}, {{5, -3}, {5, 3}}, {{5, 3}, {1, 3}}, {{1, 3}, {1, 4}}, {{1, 4}, {-4, 4}}, {{-4, 4}, {-4, -3}}};
const std::vector<Wall> kCorridor{{{-30, -1}, {30, -1}}, {{30, 1}, {-30, 1}}};

/// Points on the walls in the base frame of a pose in the room, with noise across and along.
PlanarScan see(const std::vector<Wall>& walls, const PlanarPose& T_map_base, double sigma_m, std::mt19937_64& random) {
  std::normal_distribution<double> noise{0.0, sigma_m};
  std::uniform_real_distribution<double> share{0.0, 1.0};
  PlanarScan scan;
  const PlanarPose T_base_map = T_map_base.inverse();
  for (const Wall& wall : walls) {
    const Eigen::Vector2d along = (wall.b - wall.a).normalized(), normal{-along.y(), along.x()};
    const int count = static_cast<int>((wall.b - wall.a).norm() / 0.05);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2d p = wall.a + share(random) * (wall.b - wall.a) + noise(random) * normal;
      scan.points.push_back((T_base_map.rotation() * p + T_base_map.translation).cast<float>());
      scan.normals.push_back((T_base_map.rotation() * normal).cast<float>());
    }
  }
  return scan;
}

LineMap map_of(const std::vector<Wall>& walls, std::mt19937_64& random) {
  LineMap map{LineMapConfig{}};
  for (int i = 0; i < 20; ++i) map.add(see(walls, PlanarPose{}, 0.01, random), PlanarPose{});
  return map;
}

TEST(LineResidual, ItsDerivativeIsThatOfFiniteDifferences) {
  std::mt19937_64 random{2};
  std::uniform_real_distribution<double> any{-3.0, 3.0};
  for (int trial = 0; trial < 50; ++trial) {
    const double direction = any(random);
    WallLine line;
    line.mean = {any(random), any(random)};
    line.normal = {std::cos(direction), std::sin(direction)};
    const PlanarPose pose{{any(random), any(random)}, any(random)};
    const Eigen::Vector2d p{any(random), any(random)};
    Eigen::RowVector3d J;
    line_residual(line, pose, p, &J);
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double kStep = 1e-6;
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(axis);
      const double by_difference =
          (line_residual(line, GroupSe2::plus(pose, d), p, nullptr) - line_residual(line, GroupSe2::plus(pose, -d), p, nullptr)) / (2.0 * kStep);
      EXPECT_NEAR(J[axis], by_difference, 1e-7);
    }
  }
}

TEST(LineMatcher, FindsThePoseInARoomAndKnowsHowWell) {
  std::mt19937_64 random{4};
  std::normal_distribution<double> normal;
  const LineMap map = map_of(kRoom, random);
  double nees = 0.0, worst_m = 0.0;
  constexpr int kTrials = 60;
  for (int trial = 0; trial < kTrials; ++trial) {
    const PlanarPose truth{{0.5 * normal(random), 0.5 * normal(random)}, 0.5 * normal(random)};
    const PlanarPose start = GroupSe2::plus(truth, {0.05 * normal(random), 0.05 * normal(random), 0.02 * normal(random)});
    const LineMatch found = match_lines(map, see(kRoom, truth, 0.01, random), start, {start, Eigen::Matrix3d::Zero()}, LineMatcherConfig{});
    ASSERT_TRUE(found.ok);
    const GroupSe2::Tangent error = GroupSe2::minus(truth, found.T_map_base);
    nees += error.dot(found.covariance.inverse() * error) / 3.0 / kTrials;
    worst_m = std::max(worst_m, error.head<2>().norm());
    EXPECT_EQ(found.free_direction.norm(), 0.0);
  }
  EXPECT_LT(worst_m, 0.01);
  EXPECT_LT(nees, 2.0) << "errors beyond what the covariance says";
}

TEST(LineMatcher, InACorridorTheWayAlongIsThePriorsAndIsTold) {
  std::mt19937_64 random{6};
  const LineMap map = map_of(kCorridor, random);
  const PlanarPose truth{{0.0, 0.2}, 0.05};
  const PlanarPose start = GroupSe2::plus(truth, {0.10, 0.05, -0.02});
  const Eigen::Matrix3d prior = Eigen::Vector3d{1.0 / (0.2 * 0.2), 1.0 / (0.2 * 0.2), 1.0 / (0.1 * 0.1)}.asDiagonal();
  const LineMatch found = match_lines(map, see(kCorridor, truth, 0.01, random), start, {start, prior}, LineMatcherConfig{});
  ASSERT_TRUE(found.ok);
  const Eigen::Vector2d off = found.T_map_base.translation - truth.translation;
  EXPECT_LT(std::abs(off.y()), 0.01) << "across";
  EXPECT_LT(std::abs(found.T_map_base.yaw_rad - truth.yaw_rad), 0.005);
  EXPECT_NEAR(off.x(), start.translation.x() - truth.translation.x(), 0.03) << "along: as the prior has it";
  EXPECT_GT(std::abs(found.free_direction.head<2>().normalized().x()), 0.99);
  EXPECT_GT(std::sqrt(found.covariance(0, 0)), 0.1) << "and is as unsure";
}

TEST(LineMatcher, WithoutWallsThePriorStays) {
  std::mt19937_64 random{8};
  const LineMap empty{LineMapConfig{}};
  const PlanarPose start{{1.0, 2.0}, 0.3};
  const LineMatch found = match_lines(empty, see(kRoom, start, 0.01, random), start, {start, Eigen::Matrix3d::Identity()}, LineMatcherConfig{});
  EXPECT_FALSE(found.ok);
  EXPECT_EQ(found.T_map_base.translation, start.translation);
}

}  // namespace
}  // namespace slamd
