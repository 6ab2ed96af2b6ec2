#include "estimator/map/plane_map.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::Random;

PlaneMapConfig small_map() {
  PlaneMapConfig config;
  config.max_voxels = 20'000;
  return config;
}

/// Points of the plane through `centre` across `normal`, half_m wide to each side, with Gaussian noise along the normal.
void add_plane(PlaneMap& map, Random& random, const Vector3d& centre, const Vector3d& normal, double sigma_m,
               int count = 2'000, double half_m = 3.0) {
  const Matrix32d basis = tangent_basis_s2(normal);
  for (int i = 0; i < count; ++i) {
    const double u = test::uniform(random, -half_m, half_m);
    const double v = test::uniform(random, -half_m, half_m);
    const Vector3d p = centre + basis * Eigen::Vector2d{u, v} + test::normal(random, sigma_m) * normal.normalized();
    map.insert(p.cast<float>());
  }
}

TEST(PlaneMap, APlaneHasItsNormalItsHeightAndItsNoise) {
  Random random{1};
  for (int run = 0; run < 10; ++run) {
    PlaneMap map{small_map()};
    const Vector3d centre = test::normal3(random, 10.0);
    const Vector3d normal = test::unit3(random);
    add_plane(map, random, centre, normal, 0.02);
    const Plane* plane = map.plane_at(centre.cast<float>());
    ASSERT_NE(plane, nullptr);
    const Vector3d n = plane->normal.cast<double>();
    EXPECT_NEAR(n.norm(), 1.0, 1e-5);
    EXPECT_LT(n.cross(normal).norm(), 0.05);
    EXPECT_LT(std::abs(normal.dot(plane->centre.cast<double>() - centre)), 0.02);
    EXPECT_GT(plane->variance_m2, 0.5 * 0.0004);
    EXPECT_LT(plane->variance_m2, 2.0 * 0.0004);
    EXPECT_NEAR(plane->axis_major.norm(), 1.0F, 1e-5F);
    EXPECT_NEAR(plane->axis_major.dot(plane->normal), 0.0F, 1e-4F);
    EXPECT_GE(plane->major_m2, plane->minor_m2);
  }
}

TEST(PlaneMap, HeightVarianceIsThatOfALineFit) {
  Plane plane;
  plane.centre = Vector3f{1, 2, 3};
  plane.normal = Vector3f::UnitZ();
  plane.axis_major = Vector3f::UnitX();
  plane.variance_m2 = 0.01F;
  plane.major_m2 = 4.0F;
  plane.minor_m2 = 1.0F;
  plane.points = 10.0F;
  EXPECT_FLOAT_EQ(plane.height_variance({1, 2, 3}), 0.001F);
  EXPECT_FLOAT_EQ(plane.height_variance({5, 2, 3}), 0.001F * 5.0F) << "16 / 4 along the major axis";
  EXPECT_FLOAT_EQ(plane.height_variance({1, 4, 3}), 0.001F * 5.0F) << "4 / 1 along the minor axis";
  EXPECT_FLOAT_EQ(plane.tilt_variance(), 0.001F);
}

TEST(PlaneMap, AVolumeOfPointsIsNoPlane) {
  Random random{2};
  PlaneMap map{small_map()};
  for (int i = 0; i < 20'000; ++i)
    map.insert(Vector3d(test::uniform(random, -2, 2), test::uniform(random, -2, 2), test::uniform(random, -2, 2))
                   .cast<float>());
  EXPECT_EQ(map.plane_at(Vector3f::Zero()), nullptr);
}

TEST(PlaneMap, ALineOfPointsIsNoPlane) {
  PlaneMap map{small_map()};
  for (int i = -200; i < 200; ++i) map.insert({0.02F * static_cast<float>(i), 0.3F, 0.3F});
  EXPECT_EQ(map.plane_at({0.0F, 0.3F, 0.3F}), nullptr);
}

TEST(PlaneMap, TooFewPointsAreNoPlane) {
  PlaneMap map{small_map()};
  map.insert({0.1F, 0.1F, 0.0F});
  map.insert({0.7F, 0.1F, 0.0F});
  map.insert({0.1F, 0.7F, 0.0F});
  EXPECT_EQ(map.plane_at({0.1F, 0.1F, 0.0F}), nullptr);
}

TEST(PlaneMap, FarFromAllPointsThereIsNoPlane) {
  Random random{3};
  PlaneMap map{small_map()};
  add_plane(map, random, Vector3d::Zero(), Vector3d::UnitZ(), 0.01);
  EXPECT_NE(map.plane_at({0, 0, 0.3F}), nullptr);
  EXPECT_EQ(map.plane_at({0, 0, 5.0F}), nullptr);
  EXPECT_EQ(map.plane_at({500, 0, 0}), nullptr);
}

TEST(PlaneMap, AnEmptyMapAndBadQueriesHaveNoPlane) {
  Random random{4};
  PlaneMap map{small_map()};
  EXPECT_EQ(map.plane_at(Vector3f::Zero()), nullptr);
  add_plane(map, random, Vector3d::Zero(), Vector3d::UnitZ(), 0.01);
  const std::size_t size = map.size();
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e30F}) {
    EXPECT_EQ(map.plane_at({bad, 0, 0}), nullptr);
    map.insert({0, bad, 0});
  }
  EXPECT_EQ(map.size(), size);
}

TEST(PlaneMap, AFrozenVoxelDoesNotFollowLaterPoints) {
  Random random{5};
  PlaneMapConfig config = small_map();
  PlaneMap map{config};
  const int enough = 400 * static_cast<int>(config.max_voxel_weight);
  add_plane(map, random, {0, 0, 0.1}, Vector3d::UnitZ(), 0.005, enough);
  const Plane before = *map.plane_at({0.2F, 0.2F, 0.1F});
  add_plane(map, random, {0, 0, 0.2}, Vector3d::UnitZ(), 0.005, enough);
  for (int i = 0; i < 30; ++i) map.maintain(Pose{});
  const Plane after = *map.plane_at({0.2F, 0.2F, 0.1F});
  EXPECT_NEAR(after.centre.z(), before.centre.z(), 0.01F);
}

TEST(PlaneMap, ThePlaneFollowsNewPointsUntilItIsFrozen) {
  PlaneMap map{small_map()};
  const auto add_grid = [&](float z) {
    for (float x = -0.9F; x < 1.0F; x += 0.45F)
      for (float y = -0.9F; y < 1.0F; y += 0.45F) map.insert({x, y, z});
  };
  add_grid(0.10F);
  add_grid(0.10F);
  const Plane* before = map.plane_at({0.0F, 0.0F, 0.1F});
  ASSERT_NE(before, nullptr);
  EXPECT_NEAR(before->centre.z(), 0.10F, 1e-4F);
  for (int i = 0; i < 6; ++i) add_grid(0.14F);
  const Plane* after = map.plane_at({0.0F, 0.0F, 0.1F});
  ASSERT_NE(after, nullptr);
  EXPECT_NEAR(after->centre.z(), 0.13F, 1e-3F) << "the mean of two grids and six";
}

TEST(PlaneMap, WhereALineGrewIntoASurfaceAPlaneIsFoundAlsoInAFrozenVoxel) {
  PlaneMapConfig config = small_map();
  PlaneMap map{config};
  for (std::uint32_t i = 0; i < 60 * config.max_voxel_weight; ++i)
    map.insert({-2.0F + 0.0667F * static_cast<float>(i % 60), 0.3F, 0.3F});
  ASSERT_EQ(map.plane_at({0.2F, 0.3F, 0.3F}), nullptr);
  for (float x = -2.0F; x < 2.0F; x += 0.05F)
    for (float y = -2.0F; y < 2.0F; y += 0.05F) map.insert({x, y, 0.3F});
  for (int i = 0; i < 30; ++i) map.maintain(Pose{});
  EXPECT_NE(map.plane_at({0.2F, 0.3F, 0.3F}), nullptr);
}

TEST(PlaneMap, ClearForgetsAMapOfAnySizeAtOnce) {
  Random random{6};
  PlaneMap map{small_map()};
  add_plane(map, random, Vector3d::Zero(), Vector3d::UnitZ(), 0.01, 60'000, 25.0);
  ASSERT_GT(map.size(), 5'000U);
  map.clear();
  EXPECT_EQ(map.size(), 0U);
  EXPECT_EQ(map.plane_at(Vector3f::Zero()), nullptr);
}

TEST(PlaneMap, AfterClearTheNewSurfaceIsNotMixedWithTheOldOne) {
  Random random{7};
  PlaneMap map{small_map()};
  for (int round = 0; round < 5; ++round) {
    const Vector3d normal = round % 2 == 0 ? Vector3d::UnitZ() : Vector3d::UnitX();
    add_plane(map, random, Vector3d::Constant(0.2), normal, 0.01, 20'000, 10.0);
    const Plane* plane = map.plane_at(Vector3f::Constant(0.2F));
    ASSERT_NE(plane, nullptr) << "round " << round;
    EXPECT_GT(std::abs(plane->normal.cast<double>().dot(normal)), 0.99) << "round " << round;
    map.clear();
    for (int i = 0; i < 20; ++i) map.maintain(Pose{});
  }
}

TEST(PlaneMap, AFullMapRefusesNewVoxelsAndKeepsItsOwn) {
  Random random{8};
  PlaneMapConfig config = small_map();
  config.max_voxels = 500;
  PlaneMap map{config};
  add_plane(map, random, Vector3d::Zero(), Vector3d::UnitZ(), 0.01, 3'000, 2.0);
  add_plane(map, random, {100, 0, 0}, Vector3d::UnitZ(), 0.01, 100'000, 30.0);
  EXPECT_LE(map.size(), 500U);
  EXPECT_NE(map.plane_at(Vector3f::Zero()), nullptr);
}

TEST(PlaneMap, WhatIsFarFromTheVehicleIsForgotten) {
  Random random{9};
  PlaneMapConfig config = small_map();
  config.max_distance_m = 20.0F;
  PlaneMap map{config};
  add_plane(map, random, Vector3d::Zero(), Vector3d::UnitZ(), 0.01);
  map.maintain({Eigen::Quaterniond::Identity(), {10, 0, 0}});
  EXPECT_NE(map.plane_at(Vector3f::Zero()), nullptr);
  for (int i = 0; i < 20; ++i) map.maintain({Eigen::Quaterniond::Identity(), {30, 0, 0}});
  EXPECT_EQ(map.plane_at(Vector3f::Zero()), nullptr);
  EXPECT_EQ(map.size(), 0U);
}

/// Planes fitted to few noisy points of a floor: the spread of their normals is what they say of themselves, and the
/// mean of n n^T over them is the true normal's and those tilts'.
TEST(PlaneNoise, TheNormalsSpreadAsTheirCovarianceSays) {
  test::Random random{9};
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero(), claimed = Eigen::Matrix3d::Zero();
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    PlaneMapConfig config;
    config.max_voxels = 1'000;
    PlaneMap map{config};
    for (int i = 0; i < 60; ++i) {
      const double x = test::uniform(random, 0.0, 0.59), y = test::uniform(random, 0.01, 0.59);
      map.insert(Eigen::Vector3d{x, y, 0.3 + test::normal(random, 0.02)}.cast<float>());
    }
    const Plane* plane = map.plane_at({0.3F, 0.25F, 0.3F});
    ASSERT_NE(plane, nullptr);
    const Eigen::Vector3d e = plane->normal.cast<double>() * (plane->normal.z() > 0.0F ? 1.0 : -1.0) - Eigen::Vector3d::UnitZ();
    spread += e * e.transpose() / kRuns;
    for (const Plane::Tilt& tilt : plane->tilts()) {
      const Eigen::Vector3d towards = tilt.towards.cast<double>();
      claimed += tilt.variance / kRuns * towards * towards.transpose();
    }
  }
  EXPECT_NEAR(claimed(0, 0) / spread(0, 0), 1.0, 0.25);
  EXPECT_NEAR(claimed(1, 1) / spread(1, 1), 1.0, 0.25);
}

}  // namespace
}  // namespace slamd
