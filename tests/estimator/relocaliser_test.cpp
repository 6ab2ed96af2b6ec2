#include "estimator/graph/relocaliser.hpp"

#include <gtest/gtest.h>

#include "estimator/graph/back_end.hpp"
#include "tests/support/box_town.hpp"

namespace slamd {
namespace {

using test::BoxTown;
using test::Random;

constexpr std::uint64_t kTown = 7;
constexpr std::size_t kPlenty = 64U << 20U;

/// A vehicle on the road around a town, in odoms that begin where and as often as a test says.
class Drive {
 public:
  explicit Drive(std::uint64_t town = kTown) : town_{BoxTown::around_circle(test::kRoadRadius_m, town)} {}

  static Pose truth(double along_m) { return test::pose_on_circle(test::kRoadRadius_m, along_m); }

  void begin_piece(double along_m) {
    ++piece_;
    T_world_odom_ = truth(along_m) * Pose{Eigen::Quaterniond{Eigen::AngleAxisd{1.0, Eigen::Vector3d::UnitZ()}}, {5.0, -3.0, 0.0}};
  }
  /// The front end counts its pieces from 0 again.
  void restart() {
    count_ = 0;
    piece_ = static_cast<std::uint32_t>(-1);
  }
  void go(double speed_mps) { speed_mps_ = speed_mps; }
  void enter(std::uint64_t town) { town_ = BoxTown::around_circle(test::kRoadRadius_m, town); }

  Keyframe keyframe(double along_m) {
    Keyframe keyframe;
    keyframe.id = count_++;
    keyframe.state.time = HostTime{std::chrono::milliseconds{250 * static_cast<std::int64_t>(count_)}};
    keyframe.state.odom_piece = piece_;
    keyframe.state.T_odom_base = T_world_odom_.inverse() * truth(along_m);
    keyframe.state.velocity_mps = keyframe.state.T_odom_base.rotation * Eigen::Vector3d{speed_mps_, 0.0, 0.0};
    keyframe.relative_covariance = 1e-6 * Matrix6d::Identity();
    keyframe.up_sigma_rad = 0.001;
    keyframe.points = town_.scan(truth(along_m), random_);
    return keyframe;
  }

 private:
  BoxTown town_;
  Random random_{11};
  Pose T_world_odom_ = truth(0.0);
  std::uint32_t piece_ = 0;
  double speed_mps_ = 0.0;
  std::uint64_t count_ = 0;
};

class RelocaliserTest : public ::testing::Test {
 protected:
  RelocaliserTest() {
    begin_back_end();
    for (double along_m = 0.0; along_m < 150.0; along_m += test::kRoadSpacing_m) add(along_m);
  }

  /// reach_m  of the odometry's own map, which holds the places within it: closures are looked for beyond
  void begin_back_end(double reach_m = 110.0) {
    BackEndConfig config;
    config.use_gps = false;
    config.loops.local_map_reach_m = reach_m;
    back_end_.emplace(make_relocaliser(config, {.T_base_lidar = {Eigen::Quaterniond::Identity(), test::kLidarInBase}, .T_base_imu = {}, .p_base_antenna = Eigen::Vector3d::Zero()}));
  }

  /// Another process takes over what this one has left. motion  of then, by the clock of the keyframes to come
  void restart(const std::optional<StoredMotion>& motion = {}) {
    StoredMap left = back_end_->mapper().stored(kPlenty);
    left.motion = motion;
    begin_back_end();
    entered_ = left.keyframes.size();
    back_end_->restore(std::move(left), HostTime{std::chrono::hours{1}});
    drive_.restart();
  }

  /// Whether it has brought anything into the map.
  bool add(double along_m) {
    const Keyframe keyframe = drive_.keyframe(along_m);
    const Relocaliser::Entered entered = back_end_->add(keyframe);
    began_anew_ |= entered.map_began_anew;
    if (entered.map_began_anew) entered_ = 0;
    for (const Keyframe& placed : entered.keyframes) EXPECT_EQ(placed.id, entered_++) << "ids have no gaps";
    back_end_->mapper().solve();
    newest_ = keyframe.state;
    return !entered.keyframes.empty();
  }

  /// Distance of the newest pose in map from the truth; map is the world as seen from the first keyframe.
  double error_m() const {
    const Pose T_map_base = back_end_->link().T_map_odom * newest_.T_odom_base;
    return (T_map_base.translation - (Drive::truth(0.0).inverse() * Drive::truth(along_m_)).translation).norm();
  }

  void expect_found_at(double along_m, double within_m) {
    for (double driven_m = 0.0; driven_m < within_m; driven_m += test::kRoadSpacing_m) {
      along_m_ = along_m + driven_m;
      if (!add(along_m_)) continue;
      EXPECT_TRUE(back_end_->link().places(newest_));
      EXPECT_LT(error_m(), 0.1);
      EXPECT_EQ(back_end_->counts().relocalised, 1U);
      return;
    }
    FAIL() << "not found within " << within_m << " m";
  }

  Drive drive_;
  std::optional<Relocaliser> back_end_;
  NavState newest_;
  double along_m_ = 0.0;
  std::uint64_t entered_ = 0;
  bool began_anew_ = false;
};

TEST_F(RelocaliserTest, APieceThatBeginsWhereTheLastOneEndedIsFoundAtOnce) {
  drive_.begin_piece(151.0);
  expect_found_at(151.0, 1.0);
}

TEST_F(RelocaliserTest, APieceThatBeginsElsewhereInTheMapIsFoundByTwoLooksThatAgree) {
  drive_.begin_piece(60.0);
  EXPECT_FALSE(add(60.0)) << "one look is not enough";
  EXPECT_FALSE(back_end_->link().places(newest_));
  expect_found_at(62.0, 30.0);
  EXPECT_FALSE(began_anew_);
}

TEST_F(RelocaliserTest, AnotherTownIsNotTakenForThisOneAndBecomesANewMap) {
  drive_.enter(99);
  drive_.begin_piece(0.0);
  double driven_m = 0.0;
  for (; !add(driven_m); driven_m += test::kRoadSpacing_m) EXPECT_FALSE(back_end_->link().places(newest_)) << "at " << driven_m;
  EXPECT_TRUE(began_anew_);
  EXPECT_GE(driven_m, RelocaliserConfig{}.patience_m - test::kRoadSpacing_m);
  EXPECT_EQ(back_end_->counts().begun_anew, 1U);
  EXPECT_EQ(back_end_->counts().relocalised, 0U);
  EXPECT_TRUE(back_end_->link().places(newest_)) << "in a map of its own";
}

TEST_F(RelocaliserTest, AfterARestartTheVehicleThatStandsWhereItStoodIsFoundByItsFirstScan) {
  restart();
  EXPECT_FALSE(back_end_->link().known) << "belief is not enough";
  drive_.begin_piece(148.5);
  expect_found_at(148.5, 1.0);
  EXPECT_FALSE(began_anew_);
}

TEST_F(RelocaliserTest, AfterARestartWhileItDrivesItIsFoundOnTheWay) {
  restart();
  drive_.go(8.0);
  drive_.begin_piece(60.0);
  expect_found_at(60.0, 30.0);
  EXPECT_FALSE(began_anew_);
}

TEST_F(RelocaliserTest, AfterARestartWhileItDrivesOnItIsFoundWhereItsMotionHasBroughtIt) {
  constexpr double kAway_s = 2.5;
  constexpr double kSpeed_mps = 6.0;
  const HostTime first{std::chrono::milliseconds{250}};  // of the keyframes to come
  StoredMotion motion{.time = first - from_seconds(kAway_s), .velocity_mps = {kSpeed_mps, 0.0, 0.0}};
  motion.angular_velocity_rads.z() = kSpeed_mps / test::kRoadRadius_m;
  restart(motion);
  drive_.go(kSpeed_mps);
  const double now_m = 148.0 + kAway_s * kSpeed_mps;
  drive_.begin_piece(now_m);
  expect_found_at(now_m, 3.0);
}

TEST_F(RelocaliserTest, AfterARestartTheMotionCarriesASecondPieceFromWhereTheVehicleWasLeft) {
  constexpr double kSpeed_mps = 8.0;
  StoredMotion motion{.time = HostTime{} - from_seconds(2.0), .velocity_mps = {kSpeed_mps, 0.0, 0.0}};
  motion.angular_velocity_rads.z() = kSpeed_mps / test::kRoadRadius_m;
  restart(motion);
  drive_.go(kSpeed_mps);
  drive_.enter(99);
  drive_.begin_piece(0.0);
  EXPECT_FALSE(add(0.0)) << "it sees another town";
  drive_.enter(kTown);
  const double now_m = 148.0 + 2.5 * kSpeed_mps;
  drive_.begin_piece(now_m);
  expect_found_at(now_m, 3.0);
}

TEST_F(RelocaliserTest, AfterARestartOneThatHasStoppedMeanwhileIsFoundAsWell) {
  restart(StoredMotion{.time = HostTime{} - std::chrono::seconds{3}, .velocity_mps = {8.0, 0.0, 0.0}});
  drive_.begin_piece(152.0);
  expect_found_at(152.0, 1.0);
}

TEST_F(RelocaliserTest, AfterARestartInAnotherTownANewMapBeginsWithTheFirstScan) {
  restart();
  drive_.enter(99);
  drive_.begin_piece(148.5);
  EXPECT_TRUE(add(148.5));
  EXPECT_TRUE(began_anew_);
  EXPECT_EQ(back_end_->mapper().keyframes().size(), 1U);
}

TEST_F(RelocaliserTest, WhatIsStoredAreTheNewestKeyframesOfTheBudget) {
  const StoredMap all = back_end_->mapper().stored(kPlenty);
  EXPECT_EQ(all.keyframes.size(), 75U);
  const StoredMap some = back_end_->mapper().stored(200'000);
  ASSERT_GT(some.keyframes.size(), 5U);
  ASSERT_LT(some.keyframes.size(), 75U);
  EXPECT_EQ(some.keyframes.back().time, all.keyframes.back().time);
  EXPECT_EQ(some.keyframes.back().cloud, all.keyframes.back().cloud);
}

TEST_F(RelocaliserTest, ClosuresOutliveARestartAndHold) {
  constexpr double kForgetful_m = 1.0;
  drive_ = Drive{};
  begin_back_end(kForgetful_m);
  entered_ = 0;
  for (double along_m = 0.0; along_m < 320.0; along_m += test::kRoadSpacing_m) add(along_m);
  StoredMap left = back_end_->mapper().stored(kPlenty);
  ASSERT_GT(left.closures.size(), 3U);
  left.sensors.accel_bias_mps2 = {0.01, -0.02, 0.03};
  begin_back_end(kForgetful_m);
  back_end_->restore(left, HostTime{std::chrono::hours{1}});
  EXPECT_EQ(back_end_->mapper().solution()->closures, left.closures.size());
  const StoredMap again = back_end_->mapper().stored(kPlenty);
  ASSERT_EQ(again.closures.size(), left.closures.size());
  for (std::size_t i = 0; i < left.closures.size(); ++i) {
    EXPECT_EQ(again.closures[i].from, left.closures[i].from);
    EXPECT_EQ(again.closures[i].to, left.closures[i].to);
    EXPECT_EQ(again.closures[i].covariance, left.closures[i].covariance);
  }
  EXPECT_EQ(again.sensors.accel_bias_mps2, left.sensors.accel_bias_mps2);
  ASSERT_TRUE(back_end_->mapper().finish());
  for (std::size_t i = 0; i < left.keyframes.size(); ++i) {
    EXPECT_LT(boxminus(back_end_->mapper().keyframes()[i].T_map_base, left.keyframes[i].T_map_base).norm(), 0.02) << i;
  }
}

TEST(MapLink, AnUnplacedPoseIsNeverTrackingAndItsCovarianceExcludesNothingNear) {
  NavState state;
  state.status = TrackingStatus::kTracking;
  const NavState told = unplaced(state);
  EXPECT_EQ(told.status, TrackingStatus::kDegraded);
  EXPECT_EQ(told.reasons, bit(StatusReason::kRelocalising));
  EXPECT_GE(told.covariance(0, 0), 1e6);
  state.status = TrackingStatus::kLost;
  EXPECT_EQ(unplaced(state).status, TrackingStatus::kLost);
}

}  // namespace
}  // namespace slamd
