#include "estimator/graph/packed_cloud.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "estimator/graph/keyframe_clouds.hpp"
#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using test::Random;

CloudPoint point(float x, float y, float z) { return {x, y, z, 10.0F}; }

std::vector<Eigen::Vector3f> unpacked(const std::vector<std::uint8_t>& packed, const CloudGrid& grid) {
  std::vector<Eigen::Vector3f> points;
  unpack_cloud(packed, grid, [&](const Eigen::Vector3f& p) { points.push_back(p); });
  return points;
}

PointCloud random_cloud(int count, double size_m) {
  Random random{7};
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3f p = test::normal3(random, size_m).cast<float>();
    cloud.push_back(point(p.x(), p.y(), p.z()));
  }
  return cloud;
}

TEST(PackedCloud, EveryPointIsNearOneThatCameBack) {
  const CloudGrid grid;
  const PointCloud cloud = random_cloud(2'000, 10.0);
  const std::vector<Eigen::Vector3f> back = unpacked(pack_cloud(cloud, grid), grid);
  const float worst_m = grid.voxel_size_m / 64.0F + 1e-4F;
  int exact = 0;
  for (const CloudPoint& p : cloud) {
    float nearest_m = std::numeric_limits<float>::infinity();
    for (const Eigen::Vector3f& q : back) nearest_m = std::min(nearest_m, (q - Eigen::Vector3f{p.x, p.y, p.z}).lpNorm<Eigen::Infinity>());
    EXPECT_LT(nearest_m, grid.voxel_size_m);
    exact += nearest_m < worst_m ? 1 : 0;
  }
  EXPECT_EQ(exact, static_cast<int>(back.size()));  // one of each voxel is kept, and that one is where it was
}

TEST(PackedCloud, OfAVoxelTheFirstPointIsKept) {
  const CloudGrid grid;
  const std::vector<Eigen::Vector3f> back = unpacked(pack_cloud(PointCloud{point(1.30F, 2.10F, 0.4F), point(1.10F, 2.30F, 0.1F)}, grid), grid);
  ASSERT_EQ(back.size(), 1U);
  EXPECT_NEAR(back[0].x(), 1.30F, 0.01F);
  EXPECT_NEAR(back[0].y(), 2.10F, 0.01F);
}

TEST(PackedCloud, WhatIsOutOfReachOrNoNumberIsLeftOut) {
  const CloudGrid grid;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const PointCloud cloud{point(60.1F, 0, 0), point(nan, 0, 0), point(0, nan, 1), point(-59.99F, 0.0F, 0.0F), point(0, 0, 59.99F)};
  EXPECT_EQ(unpacked(pack_cloud(cloud, grid), grid).size(), 2U);
  EXPECT_TRUE(pack_cloud({}, grid).empty());
}

TEST(PackedCloud, APointTakesAtMostFiveBytes) {
  const CloudGrid grid;
  const PointCloud cloud = random_cloud(3'000, 10.0);
  const std::vector<std::uint8_t> packed = pack_cloud(cloud, grid);
  EXPECT_LE(packed.size(), 5 * unpacked(packed, grid).size());
}

TEST(KeyframeClouds, BeyondTheBudgetTheOldestLoseTheirPoints) {
  const PointCloud cloud = random_cloud(1'000, 15.0);
  const std::size_t bytes = pack_cloud(cloud, {}).size();
  KeyframeClouds clouds{{.grid = {}, .every = 1, .byte_budget = 3 * bytes}, Eigen::Vector3d::Zero()};
  OdometryChain chain;
  for (int i = 0; i < 10; ++i) {
    chain.add({Eigen::Quaterniond::Identity(), {1.5 * i, 0.0, 0.0}}, 1e-6 * Matrix6d::Identity());
    clouds.add(cloud);
    EXPECT_LE(clouds.bytes(), 3 * bytes);
  }
  EXPECT_EQ(clouds.forgotten(), 7U);
  EXPECT_TRUE(clouds.submap(chain, 3, 3, 3).points.empty());
  EXPECT_EQ(clouds.submap(chain, 8, 1, 1).points.size(), 3 * unpacked(pack_cloud(cloud, {}), {}).size());
}

TEST(KeyframeClouds, EverySecondKeyframeKeepsItsPoints) {
  const PointCloud cloud = random_cloud(1'000, 15.0);
  KeyframeClouds clouds{{}, Eigen::Vector3d::Zero()};
  OdometryChain chain;
  for (int i = 0; i < 10; ++i) {
    chain.add({Eigen::Quaterniond::Identity(), {1.5 * i, 0.0, 0.0}}, 1e-6 * Matrix6d::Identity());
    clouds.add(cloud);
  }
  EXPECT_EQ(clouds.bytes(), 5 * pack_cloud(cloud, {}).size());
  const Submap submap = clouds.submap(chain, 4, 2, 1);  // of 2, 3, 4, 5
  EXPECT_EQ(submap.points.size(), 2 * unpacked(pack_cloud(cloud, {}), {}).size());
  EXPECT_EQ(submap.viewpoints.size(), 4U);
}

}  // namespace
}  // namespace slamd
