#include "daemon/store/map_store.hpp"

#include <gtest/gtest.h>

#include <random>
#include <thread>

namespace slamd {
namespace {

Keyframe keyframe_with(std::uint64_t id, PointCloud points, const Eigen::Vector3d& position = Eigen::Vector3d::Zero()) {
  Keyframe keyframe;
  keyframe.id = id;
  keyframe.state.T_odom_base.translation = position;
  keyframe.points = std::move(points);
  return keyframe;
}

PointCloud random_points(std::size_t count, unsigned seed) {
  std::mt19937 random{seed};
  std::uniform_real_distribution<float> coordinate{-49.99F, 49.99F};
  PointCloud points(count);
  for (CloudPoint& point : points) point = {coordinate(random), coordinate(random), coordinate(random), 100.0F};
  return points;
}

TEST(MapStore, PlacesPointsWhereTheKeyframeLiesInMap) {
  MapStore store;
  Keyframe keyframe = keyframe_with(0, {{1.0F, 0.0F, 0.5F, 42.0F}}, {10.0, 0.0, 0.0});
  Pose T_map_odom;
  T_map_odom.rotation = Eigen::AngleAxisd{M_PI / 2, Eigen::Vector3d::UnitZ()};
  store.add(keyframe, T_map_odom);
  const MapSnapshot snapshot = store.snapshot({});
  ASSERT_EQ(snapshot.points().size(), 1U);
  EXPECT_NEAR(snapshot.points()[0].x, 0.0, 0.003);
  EXPECT_NEAR(snapshot.points()[0].y, 11.0, 0.003);
  EXPECT_NEAR(snapshot.points()[0].z, 0.5, 0.003);
  EXPECT_EQ(snapshot.points()[0].intensity, 42.0F);
}

TEST(MapStore, MovesKeyframesThatWereCorrected) {
  MapStore store;
  store.add(keyframe_with(0, {{1.0F, 0.0F, 0.0F, 1.0F}}));
  store.add(keyframe_with(1, {{2.0F, 0.0F, 0.0F, 1.0F}}));
  KeyframePose moved{.id = 1, .T_map_base = {}};
  moved.T_map_base.translation.z() = 7.0;
  const KeyframePose unknown{.id = 99, .T_map_base = {}};
  store.move(std::array{moved, unknown});
  const MapSnapshot snapshot = store.snapshot({});
  ASSERT_EQ(snapshot.points().size(), 2U);
  EXPECT_NEAR(snapshot.points()[0].z, 0.0, 0.003);
  EXPECT_NEAR(snapshot.points()[1].z, 7.0, 0.003);
}

TEST(MapStore, KeepsOnePointInEachVoxelOfTheQuery) {
  MapStore store;
  for (std::uint64_t id = 0; id < 4; ++id) store.add(keyframe_with(id, random_points(20'000, 1)));
  const MapSnapshot coarse = store.snapshot({.box = {}, .voxel_size_m = 10.0});
  EXPECT_EQ(coarse.points().size(), 1000U) << "10 x 10 x 10 voxels, twenty points in each on average";
  EXPECT_EQ(coarse.keyframes, 4U);
}

TEST(MapStore, GivesOnlyWhatLiesInTheBox) {
  MapStore store;
  store.add(keyframe_with(0, random_points(5000, 2)));
  store.add(keyframe_with(1, random_points(10, 3), {1000.0, 0.0, 0.0}));
  MapQuery query{.box = {.min_m = {0, 0, -100}, .max_m = {50, 50, 100}}, .voxel_size_m = 0.01};
  const MapSnapshot snapshot = store.snapshot(query);
  EXPECT_EQ(snapshot.keyframes, 1U) << "the far keyframe is not even looked at";
  EXPECT_GT(snapshot.points().size(), 1000U);
  const PointCloud found = snapshot.points();
  for (const CloudPoint& point : found) ASSERT_TRUE(point.x >= 0 && point.y >= 0);
}

TEST(MapStore, AMapGoneThroughInSharesOfItsVoxelsLosesNothing) {
  MapStore store{{.voxel_size_m = 0.2, .shared_keyframes = 1}};
  for (std::uint64_t id = 0; id < 21; ++id) store.add(keyframe_with(id, random_points(100'000, 7)));
  ASSERT_GT(store.counts().points, 2'050'000U) << "more than one pass holds";
  const MapSnapshot whole = store.snapshot({});
  EXPECT_EQ(whole.keyframes, 21U);
  EXPECT_NEAR(static_cast<double>(whole.size()), static_cast<double>(store.counts().points) / 21.0, 10.0)
      << "each keyframe has the same voxels";
  MapQuery half;
  half.max_points = whole.size() / 2;
  EXPECT_EQ(store.snapshot(half).size(), half.max_points);
  EXPECT_TRUE(store.snapshot(half).truncated);
}

TEST(MapStore, StopsAtMaxPointsAndSaysSo) {
  MapStore store;
  store.add(keyframe_with(0, random_points(5000, 4)));
  const MapSnapshot snapshot = store.snapshot({.box = {}, .voxel_size_m = 0.01, .max_points = 77});
  EXPECT_EQ(snapshot.points().size(), 77U);
  EXPECT_TRUE(snapshot.truncated);
}

TEST(MapStore, ForgetsTheOldestKeyframesBeyondItsBudget) {
  constexpr std::size_t kBudget = 10 * (1000 * 8 + 400);  // ten keyframes and their list nodes
  MapStore store{{.voxel_size_m = 0.01, .byte_budget = kBudget}};
  for (std::uint64_t id = 0; id < 25; ++id) {
    store.add(keyframe_with(id, random_points(1000, 5), {10.0 * static_cast<double>(id), 0.0, 0.0}));
    ASSERT_LE(store.counts().bytes, kBudget);
  }
  const MapCounts counts = store.counts();
  EXPECT_EQ(counts.evicted_keyframes + counts.keyframes, 25U);
  EXPECT_GE(counts.keyframes, 10U);
  const MapSnapshot snapshot = store.snapshot({.box = {}, .voxel_size_m = 0.01});
  EXPECT_EQ(snapshot.points().size(), counts.points);
  EXPECT_GT(snapshot.points().back().x, 150.0F) << "the newest keyframe is there";
}

TEST(MapStore, WhatTheBudgetMadeItForgetIsStoredAgainWhenSeenAgain) {
  constexpr std::size_t kBudget = 4 * (1000 * 8 + 400) + 2000;  // four keyframes and the last
  MapStore store{{.voxel_size_m = 0.01, .byte_budget = kBudget}};
  const PointCloud wall = random_points(1000, 5);
  store.add(keyframe_with(0, wall));
  for (unsigned id = 1; id < 10; ++id) store.add(keyframe_with(id, random_points(1000, 5 + id)));
  ASSERT_GT(store.counts().evicted_keyframes, 0U);
  const std::size_t before = store.counts().points;
  store.add(keyframe_with(10, PointCloud(wall.begin(), wall.begin() + 100)));
  EXPECT_EQ(store.counts().points, before + 100) << "keyframe 0 is among the 150 before, but its points are gone";
}

TEST(MapStore, CountsAndDropsWhatCannotBeAPoint) {
  MapStore store;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  store.add(keyframe_with(0, {{nan, 0, 0, 1}, {0, 1e30F, 0, 1}, {161, 0, 0, 1}, {1, 2, 3, nan}}));
  EXPECT_EQ(store.counts().rejected_points, 3U);
  ASSERT_EQ(store.snapshot({}).points().size(), 1U);
  store.add(keyframe_with(0, {{1, 1, 1, 1}}));
  store.add(keyframe_with(1, {{1, 1, 1, 1}}, {std::nan(""), 0, 0}));
  EXPECT_EQ(store.counts().rejected_keyframes, 2U);
}

TEST(MapStore, TellsItsProgressAndStopsWhenToldTo) {
  MapStore store;
  for (std::uint64_t id = 0; id < 10; ++id) store.add(keyframe_with(id, random_points(10, 6)));
  std::vector<double> shares;
  const MapSnapshot snapshot = store.snapshot({}, [&shares](double share) {
    shares.push_back(share);
    return shares.size() < 5;
  });
  EXPECT_EQ(snapshot.keyframes, 4U);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
}

TEST(MapStore, DoesNotStoreASurfaceAgainThatARecentKeyframeHas) {
  MapStore store{{.shared_keyframes = 5}};
  const PointCloud points = random_points(1000, 8);
  store.add(keyframe_with(0, points));
  const std::size_t once = store.counts().points;
  EXPECT_GT(once, 990U);
  for (std::uint64_t id = 1; id < 5; ++id) store.add(keyframe_with(id, points));
  EXPECT_EQ(store.counts().points, once) << "the keyframes before have all of it";
  store.add(keyframe_with(5, points));
  EXPECT_EQ(store.counts().points, 2 * once) << "a later pass stores its own";
}

TEST(MapStore, SharedSurfacesAreFoundInOdomWhereverOdomLiesInMap) {
  MapStore store;
  Pose T_map_odom;
  store.add(keyframe_with(0, {{12.05F, 0.05F, 0.05F, 1.0F}}), T_map_odom);
  T_map_odom.translation = {3.0, -2.0, 1.0};  // the back end has learnt something in between
  store.add(keyframe_with(1, {{10.05F, 0.05F, 0.05F, 1.0F}, {9.0F, 0, 0, 2.0F}}, {2.0, 0.0, 0.0}), T_map_odom);
  EXPECT_EQ(store.counts().points, 2U) << "the first point of the second keyframe is the one of the first";
}

TEST(MapStore, CountsChangesOfWhatASnapshotShows) {
  MapStore store;
  store.add(keyframe_with(0, {{1.0F, 0.0F, 0.0F, 1.0F}}));
  EXPECT_EQ(store.counts().changes, 1U);
  KeyframePose pose{.id = 0, .T_map_base = {}};
  store.move(std::array{pose});
  EXPECT_EQ(store.counts().changes, 1U) << "it was there already";
  pose.T_map_base.translation.x() = 1.0;
  store.move(std::array{pose, KeyframePose{.id = 7, .T_map_base = {}}});
  EXPECT_EQ(store.counts().changes, 2U);
  EXPECT_EQ(store.counts().moved_keyframes, 1U);
}

TEST(MapStore, CanBeReadWhileTheMappingThreadWrites) {
  MapStore store{{.voxel_size_m = 0.1, .byte_budget = 50'000}};
  std::thread writer{[&store] {
    for (std::uint64_t id = 0; id < 200; ++id) store.add(keyframe_with(id, random_points(500, 7), {200.0 * static_cast<double>(id), 0, 0}));
  }};
  std::size_t most = 0;
  while (store.counts().keyframes + store.counts().evicted_keyframes < 200) {
    most = std::max(most, store.snapshot({.box = {}, .voxel_size_m = 0.01}).keyframes);
    std::this_thread::yield();
  }
  writer.join();
  EXPECT_EQ(store.snapshot({}).keyframes, store.counts().keyframes);
  EXPECT_LE(most, 50'000U / (400 * 8));
}

}  // namespace
}  // namespace slamd
