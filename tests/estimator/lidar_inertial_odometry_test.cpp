#include "estimator/odometry/lidar_inertial_odometry.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

#include <array>
#include <span>

#include "tests/support/odometry_run.hpp"
#include "tests/support/thread_accounting.hpp"

namespace slamd {
namespace {

using test::has;
using test::small_config;
using test::SwingingMotion;
using test::SyntheticDrive;

class Odometry : public test::OdometryRun {};

TEST_F(Odometry, StartsAtRestAndTracksTheDrive) {
  run(8.0);
  ASSERT_GT(results_.size(), 70U);
  EXPECT_EQ(results_.front().state.status, TrackingStatus::kInitialising);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_error(1.5), 0.05);
  EXPECT_EQ(odometry_.stats().fusion.unfused, 0U);
  EXPECT_EQ(odometry_.stats().imu.out_of_order, 0U);
  EXPECT_EQ(odometry_.stats().imu.frozen, 0U);
  EXPECT_EQ(odometry_.stats().imu.implausible, 0U);
  for (std::size_t i = 1; i < results_.size(); ++i) ASSERT_GT(results_[i].state.time, results_[i - 1].state.time);
}

TEST_F(Odometry, BaseIsLevelAtOdomsOriginAtTheStart) {
  run(1.5);
  const NavState& state = results_.back().state;
  EXPECT_LT(state.T_odom_base.translation.norm(), 0.02);
  EXPECT_LT(log_so3(state.T_odom_base.rotation).norm(), 0.02);
  EXPECT_LT(state.velocity_mps.norm(), 0.1);
}

TEST_F(Odometry, VelocityAndRateAreThoseOfTheBase) {
  run(6.0);
  const NavState& state = results_.back().state;
  const double t = SyntheticDrive::seconds(state.time);
  const auto pose_at = [&](double s) { return drive_.T_world_base(SyntheticDrive::at(s)); };
  const Pose before = pose_at(t - 0.01), after = pose_at(t + 0.01);
  const Eigen::Vector3d v_base = pose_at(t).rotation.conjugate() * (after.translation - before.translation) / 0.02;
  EXPECT_LT((state.T_odom_base.rotation.conjugate() * state.velocity_mps - v_base).norm(), 0.1);
  EXPECT_LT((state.angular_velocity_rads - log_so3(before.rotation.conjugate() * after.rotation) / 0.02).norm(), 0.03);
}

TEST_F(Odometry, KeyframesAreDeskewedIntoTheBaseFrame) {
  std::size_t keyframes = 0;
  drive_.play(
      0.0, 6.0, [&](const ImuSample& sample) { odometry_.add(sample); },
      [&](const LidarPacket& packet) {
        odometry_.add(packet);
        const ScanResult* result = odometry_.step();
        if (result == nullptr || !result->is_keyframe) return;
        ++keyframes;
        const Pose T_world_base = drive_.T_world_base(result->state.time);
        std::size_t on_floor = 0;
        for (const CloudPoint& p : odometry_.keyframe_points()) {
          const Eigen::Vector3d p_world = T_world_base * Eigen::Vector3d{p.x, p.y, p.z};
          ASSERT_GT(p_world.z(), -0.1);
          ASSERT_LT(p_world.z(), 5.1);
          on_floor += std::abs(p_world.z()) < 0.05 ? 1 : 0;
        }
        EXPECT_GT(odometry_.keyframe_points().size(), 20'000U);
        EXPECT_GT(on_floor, 1'000U);
      });
  EXPECT_GE(keyframes, 2U);
}

TEST_F(Odometry, AMovingStartIsTrackedAfterAFewScans) {
  drive_ = SyntheticDrive{SwingingMotion{.start_s = -3.0}};
  run(8.0);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_error(3.0), 0.15);
}

TEST_F(Odometry, WithoutAnyEventNothingHappens) {
  odometry_.advance(SyntheticDrive::at(100.0));
  EXPECT_EQ(odometry_.step(), nullptr);
}

TEST_F(Odometry, StagesAreToldInTheOrderOfTheWork) {
  struct Stages : StageListener {
    void finished(Stage stage) override { told.push_back(stage); }
    std::vector<Stage> told;
  } listener;
  run(2.0);
  odometry_.set_stage_listener(&listener);
  for (std::size_t scans = results_.size(); results_.size() < scans + 3; run(now_s_ + 0.005)) {
    if (results_.size() == scans + 1) listener.told.clear();  // the next scan is wholly heard
    if (results_.size() == scans + 2) break;
  }
  ASSERT_GE(listener.told.size(), 6U);
  EXPECT_EQ(listener.told[0], Stage::kPropagate);
  EXPECT_EQ(listener.told[1], Stage::kDeskew);
  EXPECT_EQ(listener.told[2], Stage::kAssociate);
  const auto middle = std::span{listener.told}.subspan(2, listener.told.size() - 4);
  for (const Stage stage : middle) EXPECT_TRUE(stage == Stage::kAssociate || stage == Stage::kSolve);
  EXPECT_EQ(middle.back(), Stage::kSolve);
  EXPECT_EQ(listener.told[listener.told.size() - 2], Stage::kInsert);
  EXPECT_EQ(listener.told.back(), Stage::kKeyframe);
}

TEST_F(Odometry, WithoutAListenerNobodyIsTold) {
  odometry_.set_stage_listener(nullptr);
  run(1.5);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking);
}

TEST_F(Odometry, SamplesOutOfOrderAreCountedAndDoNoHarm) {
  drive_.play(
      0.0, 5.0,
      [&](const ImuSample& sample) {
        odometry_.add(sample);
        ImuSample old = sample;
        old.time -= std::chrono::milliseconds{50};
        old.accel_mps2.setConstant(50.0);
        odometry_.add(old);
        take(sample.arrival);
      },
      [&](const LidarPacket& packet) {
        odometry_.add(packet);
        take(packet.arrival);
      });
  EXPECT_EQ(odometry_.stats().imu.out_of_order, 1'000U);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking);
  EXPECT_LT(worst_error(1.5), 0.05);
}

TEST_F(Odometry, ValuesThatAreNotFiniteNeverReachThePoseOrAKeyframe) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::uint64_t spoiled = 0;
  drive_.play(
      0.0, 5.0,
      [&](ImuSample sample) {
        if (SyntheticDrive::seconds(sample.time) > 2.0 && ++spoiled % 10 == 0) sample.gyro_rads.x() = kNan;
        odometry_.add(sample);
        take(sample.arrival);
        if (results_.empty()) return;
        for (const CloudPoint& p : odometry_.keyframe_points()) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
      },
      [&](LidarPacket packet) {
        for (std::size_t i = 0; i < packet.point_count; i += 7) packet.points[i].y = kNan;
        odometry_.add(packet);
        take(packet.arrival);
      });
  EXPECT_EQ(odometry_.stats().imu.not_finite, spoiled / 10);
  for (const ScanResult& result : results_) {
    ASSERT_TRUE(result.state.covariance.allFinite());
    ASSERT_TRUE(result.state.T_odom_base.translation.allFinite());
  }
  EXPECT_LT(worst_error(1.5), 0.05);
}

TEST_F(Odometry, LostPacketsMakeAScanIncompleteAndAreSurvived) {
  int packets = 0;
  drive_.play(
      0.0, 6.0,
      [&](const ImuSample& sample) {
        odometry_.add(sample);
        take(sample.arrival);
      },
      [&](const LidarPacket& packet) {
        if (++packets % 50 > 5) odometry_.add(packet);
        take(packet.arrival);
      });
  bool said = false;
  for (const ScanResult& result : results_) said |= has(result.state, StatusReason::kLidarIncomplete);
  EXPECT_TRUE(said);
  EXPECT_LT(worst_error(1.5), 0.06);
}

TEST_F(Odometry, WhoHasTooLittleTimeWorksOnFewerPointsOrLetsScansGo) {
  run(3.0);
  const std::size_t before = results_.size();
  std::uint64_t scan = 0;
  drive_.play(
      3.0, 6.0, [&](const ImuSample& sample) { odometry_.add(sample); },
      [&](const LidarPacket& packet) {
        odometry_.add(packet);
        if (!odometry_.due()) return;
        const HostTime end = *odometry_.due();
        const double share = std::array{1.0, 0.25, 0.0}[scan++ % 3];
        const ScanResult* result = odometry_.step(share);
        ASSERT_EQ(result == nullptr, share == 0.0);
        if (result == nullptr) return;
        EXPECT_EQ(result->state.time, end);
        EXPECT_TRUE(result->update.fused);
        EXPECT_LT(result->update.inliers, share < 1.0 ? 900 : 4'000);
        results_.push_back(*result);
      });
  EXPECT_GT(results_.size(), before + 15);
  EXPECT_EQ(odometry_.stats().scans_let_go, scan / 3);
  EXPECT_NEAR(static_cast<double>(odometry_.stats().scans_thinned), static_cast<double>(scan) / 3.0, 1.0);
  EXPECT_LT(worst_error(1.5), 0.08);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
}

TEST_F(Odometry, TheSameEventsGiveTheSameBits) {
  run(4.0);
  const std::vector<ScanResult> first = results_;
  LidarInertialOdometry again{drive_.vehicle(), small_config()};
  std::size_t i = 0;
  const auto compare = [&](HostTime now) {
    again.advance(now);
    const ScanResult* result = again.step();
    if (result == nullptr) return;
    ASSERT_LT(i, first.size());
    ASSERT_EQ(result->state.T_odom_base.translation, first[i].state.T_odom_base.translation);
    ASSERT_EQ(result->state.T_odom_base.rotation.coeffs(), first[i].state.T_odom_base.rotation.coeffs());
    ASSERT_EQ(result->state.covariance, first[i].state.covariance);
    ASSERT_EQ(result->snapshot.covariance, first[i].snapshot.covariance);
    ++i;
  };
  drive_.play(
      0.0, 4.0,
      [&](const ImuSample& sample) {
        again.add(sample);
        compare(sample.arrival);
      },
      [&](const LidarPacket& packet) {
        again.add(packet);
        compare(packet.arrival);
      });
  EXPECT_EQ(i, first.size());
}

TEST_F(Odometry, AfterWarmUpNothingIsAllocatedOrLocked) {
  if (!thread_accounting_works()) GTEST_SKIP() << "the sanitizer has its own allocator";
  pthread_setname_np(pthread_self(), "odometry");
  run(3.0);
  std::uint64_t allocations = 0, locks = 0;
  const auto counted = [&](const auto& work) {
    const ThreadAccount before = thread_account("odometry");
    const ThreadAccount idle = thread_account("odometry");  // what asking itself costs
    work();
    const ThreadAccount after = thread_account("odometry");
    allocations += after.allocations - idle.allocations - (idle.allocations - before.allocations);
    locks += after.locks - idle.locks - (idle.locks - before.locks);
  };
  drive_.play(
      3.0, 6.0, [&](const ImuSample& sample) { counted([&] { odometry_.add(sample); }); },
      [&](const LidarPacket& packet) {
        counted([&] {
          odometry_.add(packet);
          odometry_.step();
        });
      });
  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(locks, 0U);
}

}  // namespace
}  // namespace slamd
