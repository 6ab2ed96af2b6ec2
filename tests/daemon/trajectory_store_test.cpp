#include "daemon/store/trajectory_store.hpp"

#include <gtest/gtest.h>

namespace slamd {
namespace {

Pose at(double x) {
  Pose pose;
  pose.translation.x() = x;
  return pose;
}

TEST(TrajectoryStore, KeepsEveryPoseUntilItIsFull) {
  TrajectoryStore store{8};
  for (int i = 0; i < 8; ++i) store.add(from_ns<HostTime>(i + 1), at(i));
  const auto poses = store.snapshot();
  ASSERT_EQ(poses.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(poses[i].T_odom_base.translation.x(), static_cast<double>(i));
  EXPECT_EQ(store.stride(), 1U);
}

TEST(TrajectoryStore, WhenFullItGrowsSparserEvenlyAndNeverLosesTheEnds) {
  TrajectoryStore store{8};
  for (int i = 0; i < 1000; ++i) {
    store.add(from_ns<HostTime>(i + 1), at(i));
    const auto poses = store.snapshot();
    ASSERT_LE(poses.size(), 8U);
    ASSERT_EQ(poses.front().T_odom_base.translation.x(), 0.0);
    ASSERT_EQ(poses.back().T_odom_base.translation.x(), i);
    for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
      ASSERT_EQ(poses[k].T_odom_base.translation.x(), static_cast<double>(k * store.stride())) << "after pose " << i;
    }
  }
  EXPECT_GE(store.size(), 4U);
}

TEST(TrajectoryStore, RefusesTimesThatGoBackAndPosesThatAreNotFinite) {
  TrajectoryStore store;
  store.add(from_ns<HostTime>(10), at(0));
  store.add(from_ns<HostTime>(10), at(1));
  store.add(from_ns<HostTime>(9), at(1));
  store.add(from_ns<HostTime>(11), at(std::nan("")));
  EXPECT_EQ(store.size(), 1U);
  EXPECT_EQ(store.rejected(), 3U);
}

TEST(TrajectoryStore, ASnapshotOfFewPosesSpansTheWholePath) {
  TrajectoryStore store;
  for (int i = 0; i < 101; ++i) store.add(from_ns<HostTime>(i + 1), at(i));
  const auto poses = store.snapshot(5);
  ASSERT_EQ(poses.size(), 5U);
  EXPECT_EQ(poses[0].T_odom_base.translation.x(), 0.0);
  EXPECT_EQ(poses[2].T_odom_base.translation.x(), 50.0);
  EXPECT_EQ(poses[4].T_odom_base.translation.x(), 100.0);
  EXPECT_TRUE(store.snapshot(0).empty());
  EXPECT_EQ(store.snapshot(1).front().T_odom_base.translation.x(), 100.0);
}

TEST(TrajectoryStore, WritesTumWithAllNineDigitsOfTheTime) {
  const std::string text = to_tum({{from_ns<HostTime>(12'000'000'345), at(1.5)}});
  EXPECT_EQ(text, "12.000000345 1.500000 0.000000 0.000000 0.000000000 0.000000000 0.000000000 1.000000000\n");
}

}  // namespace
}  // namespace slamd
