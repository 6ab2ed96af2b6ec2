#include "daemon/threads/keyframe_feed.hpp"

#include <gtest/gtest.h>

#include "estimator/graph/odometry_chain.hpp"
#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

/// A drive of keyframes into a ring of two, which takes one when the test says so.
class Feed : public ::testing::Test {
 protected:
  ScanResult next() {
    ScanResult result;
    result.is_keyframe = true;
    result.state.T_odom_base = T_odom_base_ = T_odom_base_ * test::random_pose(random_);
    const Matrix6d root = Matrix6d::NullaryExpr([this] { return 0.01 * test::normal(random_); });
    result.relative_covariance = root * root.transpose();
    result.scan_span = std::chrono::milliseconds{50};
    chain_.add(result.state.T_odom_base, result.relative_covariance);
    feed_.offer(result, points_);
    return result;
  }
  Keyframe taken() {
    const Keyframe keyframe = *ring_.front();
    ring_.pop();
    return keyframe;
  }

  test::Random random_{3};
  SpscRing<Keyframe> ring_{2, [](Keyframe& slot) { slot.points.reserve(2); }};
  KeyframeFeed feed_{ring_};
  OdometryChain chain_;
  PointCloud points_{{1.0F, 2.0F, 3.0F, 4.0F}};
  Pose T_odom_base_;
};

TEST_F(Feed, AKeyframeArrivesAsItWasMade) {
  next();
  const ScanResult second = next();
  taken();
  const Keyframe keyframe = taken();
  EXPECT_EQ(keyframe.id, 1U);
  EXPECT_EQ(keyframe.relative_covariance, second.relative_covariance);
  EXPECT_EQ(keyframe.scan_span, second.scan_span);
  ASSERT_EQ(keyframe.points.size(), 1U);
  EXPECT_EQ(keyframe.points[0].z, 3.0F);
}

TEST_F(Feed, AfterKeyframesThatFoundNoRoomTheNextIsRelatedToTheLastThatDid) {
  for (int i = 0; i < 5; ++i) next();  // 2, 3 and 4 find the ring full
  taken();
  next();
  taken();
  const Keyframe joined = taken();
  EXPECT_EQ(joined.id, 2U) << "ids have no gaps";
  EXPECT_TRUE(joined.relative_covariance.isApprox(chain_.relative_covariance(1, 5), 1e-9));
  const ScanResult after = next();
  EXPECT_EQ(taken().relative_covariance, after.relative_covariance) << "nothing was left out in between";
  EXPECT_EQ(ring_.counts().dropped, 3U);
  EXPECT_EQ(feed_.count(), 4U);
}

TEST_F(Feed, PointsThatASlotHasNoRoomForAreLeftOut) {
  points_.resize(10, {0.0F, 0.0F, 0.0F, 0.0F});
  next();
  EXPECT_EQ(taken().points.size(), 2U);
}

TEST_F(Feed, BiasesOfAnImuThatScansContradictedAMinuteAgoGoIntoNoKeyframe) {
  const auto biases_at = [this](double seconds, double bias, bool contradicted) {
    ScanResult result;
    result.is_keyframe = true;
    result.imu_contradicted = contradicted;
    result.state.status = TrackingStatus::kTracking;
    result.state.time = HostTime{from_seconds(seconds)};
    result.state.gyro_bias_rads.setConstant(bias);
    result.state.accel_bias_mps2.setConstant(10.0 * bias);
    feed_.see(result);
    feed_.offer(result, points_);
    const NavState state = taken().state;
    EXPECT_EQ(state.accel_bias_mps2, 10.0 * state.gyro_bias_rads);
    return state.gyro_bias_rads.x();
  };
  EXPECT_EQ(biases_at(10.0, 0.01, false), 0.01);
  EXPECT_EQ(biases_at(20.0, 0.3, true), 0.01);
  EXPECT_EQ(biases_at(79.9, 0.3, false), 0.01) << "what the lie made of them";
  EXPECT_EQ(biases_at(80.0, 0.02, false), 0.02);
}

}  // namespace
}  // namespace slamd
