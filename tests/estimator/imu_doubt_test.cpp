// Which of scan and IMU is believed, and what becomes of the biases.

#include "estimator/odometry/imu_doubt.hpp"

#include <gtest/gtest.h>

namespace slamd {
namespace {

using I = ErrorIndex;

constexpr ImuDoubtConfig kConfig;
constexpr double kMostTestRatio = 4.0;

UpdateSummary fused(double attitude_correction, double position_correction, double test_ratio) {
  UpdateSummary update;
  update.fused = true;
  update.attitude_correction = attitude_correction;
  update.position_correction = position_correction;
  update.test_ratio = test_ratio;
  return update;
}

TEST(ImuDoubt, AScanFitsThatIsFusedAndAgreesWithTheMap) {
  EXPECT_TRUE(fits(fused(20.0, 20.0, 3.9), kMostTestRatio));
  EXPECT_FALSE(fits(fused(0.1, 0.1, 4.1), kMostTestRatio));
  EXPECT_FALSE(fits(UpdateSummary{}, kMostTestRatio));
}

TEST(ImuDoubt, AScanFitsFarBetterThatHasNearlyAllItsPointsOnTheMapAndManyMoreThanBefore) {
  UpdateSummary update = fused(20.0, 20.0, 6.5);
  update.matched = 1000;
  update.inliers = 950;
  EXPECT_TRUE(fits_far_better(kConfig, update, 700));
  EXPECT_FALSE(fits_far_better(kConfig, update, 900)) << "not many more";
  update.inliers = 850;
  EXPECT_FALSE(fits_far_better(kConfig, update, 700)) << "not nearly all";
}

TEST(ImuDoubt, AScanMovesThePoseThatCorrectsAttitudeOrPositionByMoreThanTheMotionsSigma) {
  EXPECT_FALSE(is_moved(kConfig, fused(8.9, 8.9, 3.9)));
  EXPECT_TRUE(is_moved(kConfig, fused(9.1, 0.0, 0.8)));
  EXPECT_TRUE(is_moved(kConfig, fused(0.0, 9.1, 0.8)));
  EXPECT_FALSE(is_moved(kConfig, UpdateSummary{}));
}

TEST(ImuDoubt, DoubtedBiasesAreUnknownAndTellNothingOfOtherStates) {
  FilterSnapshot filter;
  filter.covariance.setIdentity();
  filter.covariance *= 1e-4;
  filter.covariance(I::kVelocity, I::kAccelBias) = filter.covariance(I::kAccelBias, I::kVelocity) = 5e-5;
  filter.clone.cross.setConstant(1e-5);
  doubt_biases(kConfig, fused(9.1, 0.0, 0.8), filter);
  EXPECT_DOUBLE_EQ(filter.covariance(I::kGyroBias, I::kGyroBias), kConfig.gyro_bias_rads * kConfig.gyro_bias_rads);
  EXPECT_DOUBLE_EQ(filter.covariance(I::kAccelBias, I::kAccelBias), kConfig.accel_bias_mps2 * kConfig.accel_bias_mps2);
  EXPECT_EQ(filter.covariance(I::kVelocity, I::kAccelBias), 0.0);
  EXPECT_EQ(filter.covariance(I::kAccelBias, I::kVelocity), 0.0);
  EXPECT_EQ(filter.clone.cross(I::kGyroBias, 0), 0.0);
  EXPECT_DOUBLE_EQ(filter.covariance(I::kVelocity, I::kVelocity), 1e-4);
  EXPECT_DOUBLE_EQ(filter.clone.cross(I::kVelocity, 0), 1e-5);
}

TEST(ImuDoubt, AGyroWhoseTurnFitsIsBelievedOn) {
  FilterSnapshot filter;
  filter.covariance.setIdentity();
  doubt_biases(kConfig, fused(0.1, 9.1, 0.8), filter);
  EXPECT_DOUBLE_EQ(filter.covariance(I::kGyroBias, I::kGyroBias), 1.0);
  EXPECT_DOUBLE_EQ(filter.covariance(I::kAccelBias, I::kAccelBias), kConfig.accel_bias_mps2 * kConfig.accel_bias_mps2);
}

}  // namespace
}  // namespace slamd
