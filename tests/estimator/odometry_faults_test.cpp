// Each sensor off, stuck, lying or back again: the front end goes on, says so, and never tells a wrong pose as a sure one.

#include <gtest/gtest.h>

#include <deque>
#include <random>

#include "tests/support/odometry_run.hpp"

namespace slamd {
namespace {

using test::has;
using test::small_config;
using test::SwingingMotion;
using test::SyntheticDrive;

/// 3 degrees of freedom: beyond this in one pose of 10^6.
constexpr double kMostSigmas = 5.5;

bool in_fault(double t) { return t >= 3.0 && t < 5.0; }

class Faults : public test::OdometryRun {
 protected:
  /// Between 3.4 s and 4.9 s every pose gives the reason and none is TRACKING; in the end all is well, and no pose of the
  /// run was surer than true.
  void expect_said_and_survived(StatusReason reason, double worst_after_m) {
    for (const ScanResult& result : results_) {
      if (seconds(result) < 3.4 || seconds(result) > 4.9) continue;
      EXPECT_NE(result.state.status, TrackingStatus::kTracking) << "at " << seconds(result);
      EXPECT_TRUE(has(result.state, reason)) << "at " << seconds(result) << " reasons " << result.state.reasons;
    }
    EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
    EXPECT_LT(worst_error(6.0), worst_after_m);
    EXPECT_LT(worst_sigmas(), kMostSigmas);
    EXPECT_EQ(odometry_.stats().imu_contradicted, 0U) << "an IMU that is back is believed";
  }
};

TEST_F(Faults, WithoutAnyThePosesAreAsSureAsTheyAreTrue) {
  run(9.0);
  EXPECT_LT(worst_error(1.5), 0.05);
  EXPECT_LT(worst_sigmas(), kMostSigmas);
}

TEST_F(Faults, AnImuGapOfTwoSeconds) {
  run(9.0, [](double t, ImuSample&) { return !in_fault(t); });
  expect_said_and_survived(StatusReason::kNoImu, 0.1);
}

TEST_F(Faults, WithoutAnyImuAVehicleThatStartsFromRestIsFollowed) {
  drive_ = SyntheticDrive{SwingingMotion{.start_s = 4.5}};
  run(11.0, [](double, ImuSample&) { return false; });
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kDegraded);
  EXPECT_TRUE(has(results_.back().state, StatusReason::kNoImu));
  EXPECT_LT(worst_error(1.5), 0.15);
}

TEST_F(Faults, AnImuThatIsStuckIsAbsent) {
  ImuSample stuck;
  run(9.0, [&](double t, ImuSample& sample) {
    if (in_fault(t)) {
      sample.gyro_rads = stuck.gyro_rads;
      sample.accel_mps2 = stuck.accel_mps2;
    }
    stuck = sample;
    return true;
  });
  expect_said_and_survived(StatusReason::kNoImu, 0.1);
  EXPECT_GT(odometry_.stats().imu.frozen, 350U);
}

TEST_F(Faults, AnImuThatSaysNothingButZeroIsAbsent) {
  run(9.0, [](double t, ImuSample& sample) {
    if (in_fault(t)) sample.gyro_rads = sample.accel_mps2 = Eigen::Vector3d::Zero();
    return true;
  });
  expect_said_and_survived(StatusReason::kNoImu, 0.1);
}

TEST_F(Faults, AnImuStuckAtTheEndOfItsRangeIsAbsent) {
  run(9.0, [](double t, ImuSample& sample) {
    if (in_fault(t)) {
      sample.gyro_rads.setConstant(9.9);
      sample.accel_mps2.setConstant(39.0);
      sample.clipped = true;
    }
    return true;
  });
  expect_said_and_survived(StatusReason::kNoImu, 0.1);
}

TEST_F(Faults, AnAccelerometerWithoutForceIsAbsent) {
  run(9.0, [](double t, ImuSample& sample) {
    if (in_fault(t)) sample.accel_mps2 *= 0.01;
    return true;
  });
  expect_said_and_survived(StatusReason::kNoImu, 0.1);
  EXPECT_GT(odometry_.stats().imu.implausible, 300U);
}

TEST_F(Faults, AnImuWhoseBiasesJumpIsSaidToLieAndItsBiasesAreLearntAnew) {
  const Eigen::Vector3d wrong_rads{0.0, 0.0, 0.3};
  run(9.0, [&](double t, ImuSample& sample) {
    if (!in_fault(t)) return true;
    sample.gyro_rads += wrong_rads;
    sample.accel_mps2.x() += 2.0;
    return true;
  });
  bool said_at_begin = false, said_at_end = false;
  Eigen::Vector3d bias_rads = Eigen::Vector3d::Zero();
  for (const ScanResult& result : results_) {
    const double t = seconds(result);
    const bool said = has(result.state, StatusReason::kImuContradicted);
    EXPECT_TRUE(!said || t > 3.0) << "at " << t;
    said_at_begin |= said && t < 3.3;
    said_at_end |= said && t > 5.0 && t < 5.3;
    if (t < 4.9) bias_rads = result.state.gyro_bias_rads;
  }
  EXPECT_TRUE(said_at_begin);
  EXPECT_TRUE(said_at_end);
  EXPECT_LT((bias_rads - wrong_rads).norm(), 0.03);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_error(1.5), 0.1);
  EXPECT_LT(worst_sigmas(), kMostSigmas);
}

TEST_F(Faults, AnImuThatIsNothingButNoiseIsNotFollowed) {
  std::mt19937_64 random{7};
  std::normal_distribution<double> noise;
  run(9.0, [&](double t, ImuSample& sample) {
    if (!in_fault(t)) return true;
    for (int axis = 0; axis < 3; ++axis) {
      sample.gyro_rads[axis] += 2.0 * noise(random);
      sample.accel_mps2[axis] += 5.0 * noise(random);
    }
    return true;
  });
  EXPECT_GT(odometry_.stats().imu_contradicted, 10U);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_error(1.5), 0.15);
  EXPECT_LT(worst_sigmas(), kMostSigmas);
}

/// Its stamps are of their arrival, as without a clock of its own: 0.3 s of silence, then what was measured 0.3 s before.
TEST_F(Faults, AnImuThatIsHeldBackIsNotFollowed) {
  std::deque<ImuSample> held;
  run(9.0, [&](double t, ImuSample& sample) {
    if (!in_fault(t)) return true;
    held.push_back(sample);
    if (t < 3.3) return false;
    sample.gyro_rads = held.front().gyro_rads;
    sample.accel_mps2 = held.front().accel_mps2;
    held.pop_front();
    return true;
  });
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_error(1.5), 0.15);
  EXPECT_LT(worst_sigmas(), kMostSigmas);
}

TEST_F(Faults, OneImuStampFarInTheFutureDoesNoHarm) {
  run(9.0, [](double t, ImuSample& sample) {
    if (t >= 3.0 && t < 3.004) sample.time += std::chrono::hours{1};
    return true;
  });
  EXPECT_EQ(odometry_.stats().imu.in_future, 1U);
  bool said = false;
  for (const ScanResult& result : results_) said |= has(result.state, StatusReason::kClockUnsure);
  EXPECT_TRUE(said);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking);
  EXPECT_LT(worst_error(1.5), 0.05);
}

TEST_F(Faults, AnImuWhoseClockStepsBackAndReturnsIsAbsentInBetween) {
  run(9.0, [](double t, ImuSample& sample) {
    if (in_fault(t)) sample.time -= std::chrono::seconds{10};
    return true;
  });
  expect_said_and_survived(StatusReason::kNoImu, 0.1);
  EXPECT_EQ(odometry_.stats().imu.clock_restarts, 1U);
}

TEST_F(Faults, ALidarGapOfThreeSeconds) {
  run(10.0, keep_sample, [](double t, LidarPacket&) { return t < 3.0 || t > 6.0; });
  double sigma_before = 0.0, sigma_in = 0.0, last_s = 0.0;
  for (const ScanResult& result : results_) {
    const double sigma = std::sqrt(result.state.covariance.topLeftCorner<3, 3>().trace());
    EXPECT_GT(seconds(result), last_s);
    last_s = seconds(result);
    if (last_s < 3.0) sigma_before = sigma;
    if (result.has_scan) continue;
    sigma_in = sigma;
    EXPECT_TRUE(has(result.state, StatusReason::kNoLidar));
    EXPECT_NE(result.state.status, TrackingStatus::kTracking);
  }
  EXPECT_GT(sigma_in, 2.0 * sigma_before);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_error(7.0), 0.1);
  EXPECT_LT(worst_sigmas(), kMostSigmas);
}

TEST_F(Faults, SilenceOfTheLidarIsToldAtItsTimeoutAndTenTimesASecond) {
  run(2.0);
  const auto gone = [](double, LidarPacket&) { return false; };
  const double last_scan_s = seconds(results_.back());
  const std::size_t scans = results_.size();
  while (results_.size() == scans) run(now_s_ + 0.005, keep_sample, gone);
  EXPECT_NEAR(now_s_, last_scan_s + small_config().lidar_timeout_s, 0.02);
  EXPECT_NEAR(seconds(results_.back()), now_s_ - 0.15, 0.01) << "a scan's latency before now";
  run(now_s_ + 2.0, keep_sample, gone);
  EXPECT_NEAR(static_cast<double>(results_.size() - scans), 20.0, 2.0);
}

TEST_F(Faults, ATimeoutShorterThanAScanIsBornOut) {
  OdometryConfig config = small_config();
  config.lidar_timeout_s = 0.01;
  odometry_ = LidarInertialOdometry{drive_.vehicle(), config};
  run(4.0);
  EXPECT_EQ(odometry_.stats().scans_late, 0U);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking);
}

TEST_F(Faults, ALidarThatRepeatsItsPictureIsAbsent) {
  constexpr std::int64_t kTurn = 75;  // packets, a little less than a revolution
  std::vector<LidarPacket> picture;
  std::size_t next = 0;
  run(9.0, keep_sample, [&](double t, LidarPacket& packet) {
    if (t >= 2.8 && picture.size() < kTurn) picture.push_back(packet);
    if (!in_fault(t)) return true;
    LidarPacket old = picture[next++ % picture.size()];
    old.time = packet.time;
    old.arrival = packet.arrival;
    packet = old;
    return true;
  });
  EXPECT_GT(odometry_.stats().queue.repeated, 15U);
  for (const ScanResult& result : results_) {
    const bool told = seconds(result) > 3.8 && seconds(result) < 4.9;
    EXPECT_TRUE(!told || has(result.state, StatusReason::kNoLidar)) << "at " << seconds(result);
  }
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_error(6.0), 0.1);
}

TEST_F(Faults, ALidarThatSeesNothing) {
  run(9.0, keep_sample, [](double t, LidarPacket& packet) {
    if (in_fault(t)) packet.point_count = 0;
    return true;
  });
  expect_said_and_survived(StatusReason::kFewInliers, 0.1);
}

TEST_F(Faults, ALidarThatSeesNothingFromTheStartOnIsNeverTracked) {
  const auto blind = [](double, LidarPacket& packet) {
    packet.point_count = 0;
    return true;
  };
  run(6.0, keep_sample, blind);
  for (const ScanResult& result : results_) EXPECT_NE(result.state.status, TrackingStatus::kTracking);
  EXPECT_EQ(odometry_.map().size(), 0U);
  const double sigma = std::sqrt(results_.back().state.covariance.topLeftCorner<3, 3>().trace());
  EXPECT_GT(sigma, 0.5);
  run(9.0);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_sigmas(), kMostSigmas) << "what dead reckoning lost stays in the covariance";
  EXPECT_EQ(results_.back().state.odom_piece, 1U) << "it was lost, and its way is no odom";
  EXPECT_EQ(odometry_.stats().resets, 1U);
}

TEST_F(Faults, BothSensorsOffForASecond) {
  const auto off = [](double t) { return t > 3.0 && t < 4.0; };
  run(8.0, [&](double t, ImuSample&) { return !off(t); }, [&](double t, LidarPacket&) { return !off(t); });
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_sigmas(), kMostSigmas);
}

TEST_F(Faults, AStuckImuWhileTheLidarIsOff) {
  ImuSample stuck;
  const auto freeze = [&](double t, ImuSample& sample) {
    if (t > 4.0 && t < 6.0) {
      sample.gyro_rads = stuck.gyro_rads;
      sample.accel_mps2 = stuck.accel_mps2;
    }
    stuck = sample;
    return true;
  };
  run(9.0, freeze, [](double t, LidarPacket&) { return t < 3.0 || t > 5.0; });
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_sigmas(), kMostSigmas);
}

TEST_F(Faults, WithoutAnImuTheLidarAloneTracksAndSaysSo) {
  run(8.0, [](double, ImuSample&) { return false; });
  ASSERT_FALSE(results_.empty());
  for (const ScanResult& result : results_) {
    EXPECT_NE(result.state.status, TrackingStatus::kTracking);
    EXPECT_TRUE(has(result.state, StatusReason::kNoImu));
  }
  EXPECT_NE(results_.back().state.status, TrackingStatus::kLost);
  EXPECT_LT(worst_error(0.5), 0.3);
  EXPECT_LT(worst_sigmas(), kMostSigmas);
}

TEST_F(Faults, AnImuThatIsStuckFromTheStartOnIsNotBelieved) {
  run(8.0, [this](double, ImuSample& sample) {
    const ImuSample first = drive_.imu(0);
    sample.gyro_rads = first.gyro_rads;
    sample.accel_mps2 = first.accel_mps2;
    return true;
  });
  EXPECT_TRUE(has(results_.back().state, StatusReason::kNoImu));
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kDegraded);
  EXPECT_LT(worst_sigmas(), kMostSigmas);
}

TEST_F(Faults, AnImuThatComesLateIsTakenUp) {
  run(9.0, [](double t, ImuSample&) { return t > 4.0; });
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
  EXPECT_LT(worst_error(0.5), 0.3);
  EXPECT_LT(worst_sigmas(), kMostSigmas);
}

TEST_F(Faults, AnImuThatComesAMomentAfterTheLidarIsWaitedFor) {
  run(4.0, [](double t, ImuSample&) { return t > 0.4; });
  for (const ScanResult& result : results_) {
    if (result.state.status == TrackingStatus::kInitialising) continue;
    EXPECT_FALSE(has(result.state, StatusReason::kNoImu)) << "at " << seconds(result);
  }
  EXPECT_LT(worst_error(1.5), 0.05);
}

TEST_F(Faults, WithoutScansThePoseIsNeverTrackingAndAtLastLost) {
  run(2.0);
  const auto gone = [](double, LidarPacket&) { return false; };
  for (double t = 2.0; t < 120.0 && results_.back().state.status != TrackingStatus::kLost; t += 5.0)
    run(t, keep_sample, gone);
  for (const ScanResult& result : results_) {
    if (seconds(result) < 2.3) continue;
    ASSERT_NE(result.state.status, TrackingStatus::kTracking);
    ASSERT_TRUE(has(result.state, StatusReason::kNoLidar));
  }
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kLost);
  EXPECT_LT(worst_sigmas(), kMostSigmas);
}

TEST_F(Faults, AStateThatIsNoNumberAnyMoreStartsOver) {
  OdometryConfig config = small_config();
  config.dead_reckoning.coast_accel_mps2_rthz = 1e200;  // its square is no number: the first gap spoils the filter
  odometry_ = LidarInertialOdometry{drive_.vehicle(), config};
  run(7.0, [](double t, ImuSample&) { return t < 3.0 || t > 3.15; });
  EXPECT_EQ(odometry_.stats().resets, 1U);
  bool said = false;
  for (const ScanResult& result : results_) {
    ASSERT_TRUE(result.state.T_odom_base.translation.allFinite());
    ASSERT_TRUE(result.state.covariance.allFinite());
    said |= has(result.state, StatusReason::kReset) && result.state.status == TrackingStatus::kInitialising;
  }
  EXPECT_TRUE(said);
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
}

TEST_F(Faults, AMovingStartThatFindsNoVelocityIsLostInTimeAndRecovers) {
  drive_ = SyntheticDrive{SwingingMotion{.start_s = -3.0}};
  run(18.0, keep_sample, [](double t, LidarPacket& packet) {
    if (t < 11.0) packet.point_count = 0;
    return true;
  });
  for (const ScanResult& result : results_) {
    const double t = seconds(result);
    EXPECT_TRUE(t > 8.0 || result.state.status == TrackingStatus::kInitialising) << "at " << t;
    EXPECT_TRUE(t < 8.6 || t > 11.0 || result.state.status == TrackingStatus::kLost) << "at " << t;
  }
  EXPECT_EQ(results_.back().state.status, TrackingStatus::kTracking) << "reasons " << results_.back().state.reasons;
}

}  // namespace
}  // namespace slamd
