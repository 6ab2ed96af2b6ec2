#include "estimator/odometry/pose_predictor.hpp"

#include <gtest/gtest.h>

#include "estimator/odometry/base_state.hpp"
#include "tests/support/synthetic_drive.hpp"

namespace slamd {
namespace {

using test::SyntheticDrive;

class Predictor : public ::testing::Test {
 protected:
  FilterSnapshot snapshot_at(double t) const {
    const Pose T_world_imu = drive_.T_world_base(SyntheticDrive::at(t)) * drive_.vehicle().T_base_imu;
    FilterSnapshot filter;
    filter.time = SyntheticDrive::at(t);
    filter.state.R_odom_imu = T_world_imu.rotation;
    filter.state.p_odom_imu = T_world_imu.translation;
    filter.state.v_odom_imu = {0.3, -0.2, 0.0};
    filter.state.gyro_bias = {0.004, -0.003, 0.002};
    filter.covariance = 1e-4 * ErrorCovariance::Identity();
    return filter;
  }

  static NavState tracking(const FilterSnapshot& filter, const Pose& T_base_imu) {
    NavState state = base_state(filter, T_base_imu);
    state.status = TrackingStatus::kTracking;
    return state;
  }

  void correct(PosePredictor& predictor, const FilterSnapshot& filter) const {
    predictor.correct(filter, tracking(filter, drive_.vehicle().T_base_imu));
  }

  static void expect_same(const NavState& a, const NavState& b) {
    EXPECT_EQ(a.time, b.time);
    EXPECT_LT((a.T_odom_base.translation - b.T_odom_base.translation).norm(), 1e-12);
    EXPECT_LT(log_so3(a.T_odom_base.rotation.conjugate() * b.T_odom_base.rotation).norm(), 1e-12);
    EXPECT_LT((a.velocity_mps - b.velocity_mps).norm(), 1e-12);
    EXPECT_LT((a.covariance - b.covariance).norm(), 1e-12);
  }

  SyntheticDrive drive_;
  DeadReckoningConfig config_;
};

TEST_F(Predictor, BeforeTheFirstPosteriorItInitialises) {
  PosePredictor predictor{drive_.vehicle(), config_, {}};
  const NavState state = predictor.add(drive_.imu(10));
  EXPECT_EQ(state.status, TrackingStatus::kInitialising);
  EXPECT_EQ(state.time, drive_.imu(10).time);
}

TEST_F(Predictor, SampleBySampleEqualsOneDeadReckoning) {
  PosePredictor predictor{drive_.vehicle(), config_, {}};
  ImuBuffer samples;
  for (int i = 0; i <= 600; ++i) samples.push(drive_.imu(i));
  for (int i = 0; i <= 600; ++i) predictor.add(drive_.imu(i));
  correct(predictor, snapshot_at(3.0));
  NavState last;
  for (int i = 601; i <= 700; ++i) {
    samples.push(drive_.imu(i));
    last = predictor.add(drive_.imu(i));
    EXPECT_EQ(last.time, drive_.imu(i).time);
  }
  FilterSnapshot filter = snapshot_at(3.0);
  DeadReckoning{config_}.advance(samples, drive_.imu(700).time, filter, [](const FilterSnapshot&) {});
  expect_same(last, base_state(filter, drive_.vehicle().T_base_imu));
  EXPECT_EQ(last.status, TrackingStatus::kTracking);
}

TEST_F(Predictor, ACorrectionInThePastAppliesTheYoungerSamplesAnew) {
  PosePredictor predictor{drive_.vehicle(), config_, {}}, direct{drive_.vehicle(), config_, {}};
  correct(predictor, snapshot_at(1.0));
  for (int i = 200; i <= 640; ++i) {
    predictor.add(drive_.imu(i));
    direct.add(drive_.imu(i));
  }
  FilterSnapshot corrected = snapshot_at(3.0117);  // 0.19 s before the newest sample, between two samples
  corrected.state.p_odom_imu += Eigen::Vector3d{0.5, 0.0, 0.0};
  correct(predictor, corrected);
  correct(direct, corrected);
  expect_same(predictor.add(drive_.imu(641)), direct.add(drive_.imu(641)));
}

TEST_F(Predictor, StatusAndReasonsAreThoseOfTheNewestPosterior) {
  PosePredictor predictor{drive_.vehicle(), config_, {}};
  NavState posterior = tracking(snapshot_at(3.0), drive_.vehicle().T_base_imu);
  posterior.status = TrackingStatus::kDegraded;
  posterior.reasons = bit(StatusReason::kDegenerateTranslation);
  posterior.degenerate_direction = Eigen::Vector3d::UnitX();
  posterior.lidar_test_ratio = 0.5F;
  predictor.correct(snapshot_at(3.0), posterior);
  const NavState state = predictor.add(drive_.imu(601));
  EXPECT_EQ(state.status, TrackingStatus::kDegraded);
  EXPECT_NE(state.reasons & bit(StatusReason::kDegenerateTranslation), 0U);
  EXPECT_EQ(state.degenerate_direction, posterior.degenerate_direction);
  EXPECT_EQ(state.lidar_test_ratio, 0.5F);
}

TEST_F(Predictor, WithoutSamplesItCoastsWithGrowingCovariance) {
  PosePredictor predictor{drive_.vehicle(), config_, {}};
  correct(predictor, snapshot_at(3.0));
  double last_sigma = 0.0;
  for (const double t : {3.05, 3.1, 3.3, 3.6, 4.0}) {
    const NavState state = predictor.coast_to(SyntheticDrive::at(t));
    EXPECT_EQ(state.time, SyntheticDrive::at(t));
    const double sigma = std::sqrt(state.covariance.topLeftCorner<3, 3>().trace());
    EXPECT_GT(sigma, last_sigma);
    last_sigma = sigma;
    const Pose start = drive_.T_world_base(SyntheticDrive::at(3.0));
    const Eigen::Vector3d expected = start.translation + (t - 3.0) * Eigen::Vector3d{0.3, -0.2, 0.0};
    EXPECT_LT((state.T_odom_base.translation - expected).norm(), 1e-9);
  }
}

TEST_F(Predictor, AStampFarInTheFutureNeitherMovesThePoseNorBlocksTheNextSamples) {
  PosePredictor predictor{drive_.vehicle(), config_, {}}, clean{drive_.vehicle(), config_, {}};
  correct(predictor, snapshot_at(3.0));
  correct(clean, snapshot_at(3.0));
  for (int i = 601; i <= 620; ++i) {
    predictor.add(drive_.imu(i));
    clean.add(drive_.imu(i));
  }
  ImuSample future = drive_.imu(620);
  future.time += std::chrono::hours{1};
  const NavState state = predictor.add(future);
  EXPECT_LT(to_seconds(state.time - drive_.imu(620).time), 0.001);
  EXPECT_NE(state.reasons & bit(StatusReason::kClockUnsure), 0U);
  EXPECT_EQ(state.status, TrackingStatus::kDegraded);
  EXPECT_LT((predictor.add(drive_.imu(621)).T_odom_base.translation -
             clean.add(drive_.imu(621)).T_odom_base.translation).norm(), 1e-5);
}

TEST_F(Predictor, AStuckImuIsSaidAtOnceAndCoasted) {
  PosePredictor predictor{drive_.vehicle(), config_, {}};
  correct(predictor, snapshot_at(3.0));
  NavState state;
  for (int i = 601; i <= 640; ++i) {
    ImuSample stuck = drive_.imu(601);
    stuck.time = drive_.imu(i).time;
    stuck.arrival = drive_.imu(i).arrival;
    state = predictor.add(stuck);
    EXPECT_EQ(state.time, stuck.time);
  }
  EXPECT_EQ(state.status, TrackingStatus::kDegraded);
  EXPECT_NE(state.reasons & bit(StatusReason::kNoImu), 0U);
}

TEST_F(Predictor, ASampleOutOfOrderChangesNothing) {
  PosePredictor predictor{drive_.vehicle(), config_, {}};
  correct(predictor, snapshot_at(3.0));
  const NavState before = predictor.add(drive_.imu(610));
  expect_same(predictor.add(drive_.imu(605)), before);
}

}  // namespace
}  // namespace slamd
