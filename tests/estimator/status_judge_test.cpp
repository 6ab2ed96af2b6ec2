#include "estimator/odometry/status_judge.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace slamd {
namespace {

const StatusConfig kConfig;

Evidence good() {
  Evidence evidence;
  evidence.has_scan = true;
  evidence.map_is_mature = true;
  evidence.update = {.fused = true, .test_ratio = 1.0};
  return evidence;
}

Judgement with(const std::function<void(Evidence&)>& change) {
  Evidence evidence = good();
  change(evidence);
  return judge(kConfig, evidence);
}

TEST(StatusJudge, WithoutAnyReasonThePoseIsTracked) {
  const Judgement judgement = judge(kConfig, good());
  EXPECT_EQ(judgement.status, TrackingStatus::kTracking);
  EXPECT_EQ(judgement.reasons, 0U);
  EXPECT_FLOAT_EQ(judgement.lidar_test_ratio, 0.25F);
}

TEST(StatusJudge, EveryWeaknessHasItsReasonAndNoOther) {
  const std::pair<std::function<void(Evidence&)>, StatusReason> table[] = {
      {[](Evidence& e) { e.has_scan = false; }, StatusReason::kNoLidar},
      {[](Evidence& e) { e.complete_scan = false; }, StatusReason::kLidarIncomplete},
      {[](Evidence& e) { e.imu_is_alive = false; }, StatusReason::kNoImu},
      {[](Evidence& e) { e.imu_is_alive = false; e.coasted = true; }, StatusReason::kNoImu},
      {[](Evidence& e) { e.coasted = true; }, StatusReason::kImuGap},
      {[](Evidence& e) { e.coasted = e.imu_contradicted = true; }, StatusReason::kImuContradicted},
      {[](Evidence& e) { e.clipped = true; }, StatusReason::kImuClipped},
      {[](Evidence& e) { e.clock_unsure = true; }, StatusReason::kClockUnsure},
      {[](Evidence& e) { e.map_restarted = true; }, StatusReason::kReset},
      {[](Evidence& e) { e.unfused_scans = 1; }, StatusReason::kFewInliers},
      {[](Evidence& e) { e.update.free_translations = 1; }, StatusReason::kDegenerateTranslation},
      {[](Evidence& e) { e.update.free_rotations = 1; }, StatusReason::kDegenerateRotation},
      {[](Evidence& e) { e.update.test_ratio = 4.1; }, StatusReason::kInnovation},
      {[](Evidence& e) { e.local_sigma_m = 0.51; }, StatusReason::kHighUncertainty},
  };
  for (const auto& [change, reason] : table) {
    const Judgement judgement = with(change);
    EXPECT_EQ(judgement.reasons, bit(reason)) << name(reason);
    EXPECT_EQ(judgement.status, TrackingStatus::kDegraded) << name(reason);
  }
}

TEST(StatusJudge, OnlyAMatureMapCanBeContradicted) {
  const Judgement judgement = with([](Evidence& e) {
    e.map_is_mature = false;
    e.update.test_ratio = 9.0;
  });
  EXPECT_EQ(judgement.status, TrackingStatus::kTracking);
}

TEST(StatusJudge, APoseNobodyCanUseIsLost) {
  EXPECT_EQ(with([](Evidence& e) { e.local_sigma_m = 4.9; }).status, TrackingStatus::kDegraded);
  EXPECT_EQ(with([](Evidence& e) { e.local_sigma_m = 5.1; }).status, TrackingStatus::kLost);
}

TEST(StatusJudge, AMovingStartInitialisesForALimitedTimeAndIsLostThen) {
  const auto searching = [](Evidence& e) {
    e.velocity_unknown = true;
    e.local_sigma_m = 8.0;
  };
  EXPECT_EQ(with(searching).status, TrackingStatus::kInitialising);
  const Judgement late = with([](Evidence& e) { e.velocity_unknown = e.velocity_overdue = true; });
  EXPECT_EQ(late.status, TrackingStatus::kLost);
  EXPECT_EQ(late.reasons, bit(StatusReason::kHighUncertainty));
}

}  // namespace
}  // namespace slamd
