#include "estimator/odometry/lidar_inertial_odometry.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

#include <functional>
#include <limits>

#include "tests/support/synthetic_drive.hpp"
#include "tests/support/thread_accounting.hpp"

namespace slamd {
namespace {

using test::SwingingMotion;
using test::SyntheticDrive;

bool has(const NavState& state, StatusReason reason) { return (state.reasons & bit(reason)) != 0U; }

OdometryConfig small_config() {
  OdometryConfig config;
  config.fusion.registration.map.max_voxels = 30'000;
  return config;
}

/// The front end on a synthetic drive: which events are lost is up to the test.
class Odometry : public ::testing::Test {
 protected:
  using Lost = std::function<bool(double)>;
  static bool never(double) { return false; }

  void run(double to_s, const Lost& no_imu = never, const Lost& no_lidar = never) {
    drive_.play(
        now_s_, to_s,
        [&](const ImuSample& sample) {
          if (!no_imu(SyntheticDrive::seconds(sample.time))) odometry_.add(sample);
          take(sample.arrival);
        },
        [&](const LidarPacket& packet) {
          if (!no_lidar(SyntheticDrive::seconds(packet.time))) odometry_.add(packet);
          take(packet.arrival);
        });
    now_s_ = to_s;
  }

  void take(HostTime now) {
    odometry_.advance(now);
    if (const ScanResult* result = odometry_.step()) results_.push_back(*result);
  }

  /// Translation of truth and estimate since the first tracked scan, compared in the frame of that scan.
  double position_error(const ScanResult& first, const ScanResult& result) const {
    const Pose truth = drive_.T_world_base(first.state.time).inverse() * drive_.T_world_base(result.state.time);
    const Pose estimate = first.state.T_odom_base.inverse() * result.state.T_odom_base;
    return (truth.translation - estimate.translation).norm();
  }

  const ScanResult& first_initialised() const {
    return *std::find_if(results_.begin(), results_.end(),
                         [](const ScanResult& r) { return r.state.status != TrackingStatus::kInitialising; });
  }

  double worst_error(double from_s) const {
    double worst = 0.0;
    for (const ScanResult& result : results_)
      if (result.has_scan && SyntheticDrive::seconds(result.state.time) >= from_s)
        worst = std::max(worst, position_error(first_initialised(), result));
    return worst;
  }

  SyntheticDrive drive_;
  LidarInertialOdometry odometry_{drive_.vehicle(), small_config()};
  std::vector<ScanResult> results_;
  double now_s_ = 0.0;
};

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

TEST_F(Odometry, AnImuGapOfTwoSecondsIsSaidAndSurvived) {
  const auto gap = [](double t) { return t > 3.0 && t < 5.0; };
  run(8.0, gap);
  bool said = false;
  for (const ScanResult& result : results_) {
    const double t = SyntheticDrive::seconds(result.state.time);
    if (t > 3.4 && t < 4.9) {
      EXPECT_NE(result.state.status, TrackingStatus::kTracking) << "at " << t;
      said |= has(result.state, StatusReason::kNoImu);
    }
  }
  EXPECT_TRUE(said);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_error(1.5), 0.3);
}

TEST_F(Odometry, ALidarGapOfThreeSecondsIsSaidAndSurvived) {
  const auto gap = [](double t) { return t > 3.0 && t < 6.0; };
  run(9.0, never, gap);
  bool said = false;
  double sigma_before = 0.0, sigma_in = 0.0;
  for (const ScanResult& result : results_) {
    const double sigma = std::sqrt(result.state.covariance.topLeftCorner<3, 3>().trace());
    const double t = SyntheticDrive::seconds(result.state.time);
    if (t < 3.0) sigma_before = sigma;
    if (!result.has_scan) {
      said = true;
      sigma_in = sigma;
      EXPECT_TRUE(has(result.state, StatusReason::kNoLidar));
      EXPECT_NE(result.state.status, TrackingStatus::kTracking);
    }
  }
  EXPECT_TRUE(said);
  EXPECT_GT(sigma_in, 2.0 * sigma_before);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_error(7.0), 0.3);
}

TEST_F(Odometry, WithoutAnImuTheLidarAloneTracksAndSaysSo) {
  run(8.0, [](double) { return true; });
  ASSERT_FALSE(results_.empty());
  for (const ScanResult& result : results_) {
    EXPECT_NE(result.state.status, TrackingStatus::kTracking);
    EXPECT_TRUE(has(result.state, StatusReason::kNoImu));
  }
  EXPECT_NE(results_.back().state.status, TrackingStatus::kLost);
  EXPECT_LT(worst_error(0.5), 0.3);
}

TEST_F(Odometry, WithoutScansThePoseIsNeverTrackingAndAtLastLost) {
  run(2.0);
  const auto gone = [](double) { return true; };
  for (double t = 2.0; t < 120.0 && results_.back().state.status != TrackingStatus::kLost; t += 5.0) run(t, never, gone);
  for (const ScanResult& result : results_) {
    if (SyntheticDrive::seconds(result.state.time) < 2.3) continue;
    ASSERT_NE(result.state.status, TrackingStatus::kTracking);
    ASSERT_TRUE(has(result.state, StatusReason::kNoLidar));
  }
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kLost);
}

TEST_F(Odometry, WithoutAnyEventNothingHappens) {
  odometry_.advance(SyntheticDrive::at(100.0));
  EXPECT_EQ(odometry_.step(), nullptr);
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
