#include "estimator/graph/submap_registration.hpp"

#include <gtest/gtest.h>

#include "tests/support/box_town.hpp"

namespace slamd {
namespace {

using test::BoxTown;
using test::Random;

std::vector<Eigen::Vector3f> points_of(const PointCloud& cloud) {
  std::vector<Eigen::Vector3f> points;
  for (const CloudPoint& p : cloud) points.emplace_back(p.x, p.y, p.z);
  return points;
}

/// What is seen around a place of the circle, in the frame of its middle.
std::vector<Eigen::Vector3f> view(const BoxTown& town, double along_m, double beside_m, Random& random) {
  const Pose T_map_middle = test::pose_on_circle(60.0, along_m, beside_m);
  std::vector<Eigen::Vector3f> points;
  for (double d = -6.0; d <= 6.0; d += 1.5) {
    const Pose T_map_base = test::pose_on_circle(60.0, along_m + d, beside_m);
    const Pose T_middle_base = T_map_middle.inverse() * T_map_base;
    for (const Eigen::Vector3f& p : points_of(town.scan(T_map_base, random))) {
      points.push_back((T_middle_base * p.cast<double>()).cast<float>());
    }
  }
  return points;
}

SubmapShape shape(const std::vector<Eigen::Vector3f>& points) {
  return shape_of(points, SubmapRegistrationConfig{}.max_points);
}

TEST(SubmapRegistration, ComesWithinCentimetresFromAGuessOfHalfAMetreAndItsCovarianceCoversTheError) {
  const BoxTown town = BoxTown::around_circle(60.0, 4);
  Random random{1};
  SubmapShape target = shape(view(town, 30.0, 0.0, random));
  double nees = 0.0;
  constexpr int kRuns = 6;
  for (int run = 0; run < kRuns; ++run) {
    const double along_m = 29.0 + 0.5 * run;
    const Pose truth = test::pose_on_circle(60.0, 30.0).inverse() * test::pose_on_circle(60.0, along_m, 1.0);
    Vector6d off;
    off << 0.4, -0.3, 0.1, 0.005, -0.005, 0.02;
    SubmapShape source = shape(view(town, along_m, 1.0, random));
    const SubmapMatch match = register_submap(target, source, boxplus(truth, off), {});
    EXPECT_TRUE(match.converged);
    EXPECT_GT(match.inlier_share, 0.6);
    EXPECT_GT(match.overlap, 0.8);
    const Vector6d error = boxminus(truth, match.T_target_source.T_a_b);
    EXPECT_LT(error.head<3>().norm(), 0.03);
    EXPECT_LT(error.tail<3>().norm(), 0.002);
    nees += error.dot(match.T_target_source.covariance.ldlt().solve(error)) / (6.0 * kRuns);
  }
  EXPECT_LT(nees, 2.0);
}

TEST(SubmapRegistration, ACorridorLeavesItsLengthFreeAndSaysSo) {
  std::vector<Eigen::Vector3f> corridor;
  Random random{2};
  for (float x = -30.0F; x <= 30.0F; x += 0.2F) {
    for (float z = 0.0F; z <= 3.0F; z += 0.2F) {
      for (const float y : {-2.0F, 2.0F}) corridor.emplace_back(x, y + static_cast<float>(test::normal(random, 0.01)), z);
    }
    for (float y = -2.0F; y <= 2.0F; y += 0.2F) corridor.emplace_back(x, y, static_cast<float>(test::normal(random, 0.01)));
  }
  SubmapShape target = shape(corridor);
  SubmapShape source = shape(corridor);
  const SubmapMatch match = register_submap(target, source, Pose{}, {});
  const Matrix6d& covariance = match.T_target_source.covariance;
  EXPECT_GT(std::sqrt(covariance(0, 0)), 50.0 * std::sqrt(covariance(1, 1)));
  EXPECT_LT(std::sqrt(covariance(1, 1)), 0.2);
}

/// Ground and a street's walls, one wall across it, and four hedges across that are seen `deeper_m` farther along.
std::vector<Eigen::Vector3f> street_with_hedges(float deeper_m, Random& random) {
  constexpr double kWallSigma_m = 0.01, kHedgeSigma_m = 0.1;
  std::vector<Eigen::Vector3f> points;
  const auto noise = [&](double sigma_m) { return static_cast<float>(test::normal(random, sigma_m)); };
  for (float x = -15.0F; x <= 15.0F; x += 0.2F) {
    for (float y = -6.0F; y <= 6.0F; y += 0.2F) points.emplace_back(x, y, noise(kWallSigma_m));
    for (float z = 0.0F; z <= 3.0F; z += 0.2F) {
      for (const float y : {-6.0F, 6.0F}) points.emplace_back(x, y + noise(kWallSigma_m), z);
    }
  }
  for (float y = -3.0F; y <= 3.0F; y += 0.1F) {
    for (float z = 0.5F; z <= 3.0F; z += 0.1F) {
      points.emplace_back(12.0F + noise(kWallSigma_m), y, z);
      for (const float x : {-9.0F, -4.0F, 1.0F, 6.0F}) points.emplace_back(x + deeper_m + noise(kHedgeSigma_m), y, z);
    }
  }
  return points;
}

TEST(SubmapRegistration, AWallCountsMoreThanHedgesThatAreSeenDeeperFromElsewhere) {
  constexpr float kDeeper_m = 0.08F;
  Random random{5};
  SubmapShape target = shape(street_with_hedges(0.0F, random));
  SubmapShape source = shape(street_with_hedges(kDeeper_m, random));
  const SubmapMatch match = register_submap(target, source, Pose{}, {});
  EXPECT_TRUE(match.converged);
  EXPECT_LT(std::abs(match.T_target_source.T_a_b.translation.x()), 0.25 * kDeeper_m);
}

TEST(SubmapRegistration, AnotherPlaceDoesNotFit) {
  Random random{3};
  SubmapShape target = shape(view(BoxTown::around_circle(60.0, 4), 30.0, 0.0, random));
  SubmapShape elsewhere = shape(view(BoxTown::around_circle(60.0, 99), 180.0, 0.0, random));
  SubmapShape there = shape(view(BoxTown::around_circle(60.0, 4), 30.0, 0.0, random));
  const SubmapMatch match = register_submap(target, elsewhere, Pose{}, {});
  const SubmapMatch same = register_submap(target, there, Pose{}, {});
  EXPECT_LT(match.inlier_share, same.inlier_share - 0.1);
}

TEST(SubmapRegistration, NoPointsAreNoMatch) {
  SubmapShape target = shape({});
  SubmapShape source = shape({});
  const SubmapMatch match = register_submap(target, source, Pose{}, {});
  EXPECT_EQ(match.inlier_share, 0.0);
  EXPECT_EQ(match.overlap, 0.0);
}

}  // namespace
}  // namespace slamd
