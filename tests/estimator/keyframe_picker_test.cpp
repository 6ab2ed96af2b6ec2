#include "estimator/odometry/keyframe_picker.hpp"

#include <gtest/gtest.h>

#include "estimator/math/lie.hpp"

namespace slamd {
namespace {

class Picker : public ::testing::Test {
 protected:
  Picker() {
    motion_.add(0.0, {});
    motion_.add(0.1, {Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0}});
    motion_.finish({});
    scan_.points = {{5.0F, 0.0F, 0.0F, 0, 0, 3, 17, 0}, {5.0F, 0.0F, 0.0F, 100'000'000, 0, 3, 18, 0}};
  }
  void take(const Pose& T_odom_base) { picker_.take(scan_, motion_, T_base_lidar_, T_odom_base); }

  KeyframeConfig config_;
  KeyframePicker picker_{config_, 100};
  ScanMotion motion_{10};
  Scan scan_;
  Pose T_base_lidar_{exp_so3({0.0, 0.0, M_PI / 2}), {0.0, 0.0, 2.0}};
};

TEST_F(Picker, TheFirstScanIsDue) { EXPECT_TRUE(picker_.is_due({})); }

TEST_F(Picker, OneIsDueAfterTravelOrRotation) {
  take({Eigen::Quaterniond::Identity(), {10.0, 0.0, 0.0}});
  const auto due = [&](double moved_m, double turned_rad) {
    return picker_.is_due({exp_so3({0.0, 0.0, turned_rad}), {10.0 + moved_m, 0.0, 0.0}});
  };
  EXPECT_FALSE(due(0.99 * config_.distance_m, 0.99 * config_.angle_rad));
  EXPECT_TRUE(due(1.01 * config_.distance_m, 0.0));
  EXPECT_TRUE(due(-1.01 * config_.distance_m, 0.0));
  EXPECT_TRUE(due(0.0, 1.01 * config_.angle_rad));
  EXPECT_TRUE(due(0.0, -1.01 * config_.angle_rad));
}

TEST_F(Picker, AfterANewOriginTheNextScanIsDue) {
  take({});
  EXPECT_FALSE(picker_.is_due({}));
  picker_.forget();
  EXPECT_TRUE(picker_.is_due({}));
}

TEST_F(Picker, PointsAreInBaseAtTheScansEnd) {
  take({});
  ASSERT_EQ(picker_.points().size(), 2U);
  const CloudPoint& early = picker_.points()[0];  // 1 m of travel before the end: 4 m ahead of the LiDAR by then
  EXPECT_NEAR(early.x, 0.0, 1e-5);
  EXPECT_NEAR(early.y, 4.0, 1e-5);
  EXPECT_NEAR(early.z, 2.0, 1e-5);
  EXPECT_EQ(early.intensity, 17.0F);
  EXPECT_NEAR(picker_.points()[1].y, 5.0, 1e-5);
}

}  // namespace
}  // namespace slamd
