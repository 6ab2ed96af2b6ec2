#include "estimator/odometry/velocity_search.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamd {
namespace {

using I = ErrorIndex;

class Search : public ::testing::Test {
 protected:
  Search() {
    initial_.time = from_ns<HostTime>(5'000'000'000);
    initial_.covariance.diagonal().setConstant(0.01);
    initial_.covariance.block<3, 3>(I::kVelocity, I::kVelocity) = 64.0 * Eigen::Matrix3d::Identity();
    search_.begin({.filter = initial_});
    filter_ = initial_;
    filter_.state.v_odom_imu = {7.0, 1.0, 0.0};
    filter_.state.gyro_bias = {0.05, 0.0, 0.0};
    filter_.state.accel_bias = {0.0, 1.0, 0.0};
    filter_.covariance *= 1e-3;
  }
  void find_velocity() {
    for (std::uint32_t i = 0; i < config_.scans; ++i) search_.fused({.fused = true}, filter_);
  }
  /// A scan that agrees with its map and has nothing to correct.
  UpdateSummary settled() const { return {.fused = true, .test_ratio = 0.9 * config_.settled_test_ratio}; }
  /// What the last scan of a round returns.
  bool round(const UpdateSummary& update) {
    for (std::uint32_t i = 1; i < config_.round_scans; ++i) EXPECT_FALSE(search_.fused(update, filter_));
    return search_.fused(update, filter_);
  }
  Eigen::Matrix3d velocity_covariance() const { return filter_.covariance.block<3, 3>(I::kVelocity, I::kVelocity); }

  VelocitySearchConfig config_;
  VelocitySearch search_{config_};
  FilterSnapshot initial_, filter_;
};

TEST_F(Search, OnlyTheVelocityIsKept) {
  search_.fused({.fused = true}, filter_);
  EXPECT_EQ(filter_.state.v_odom_imu, (Eigen::Vector3d{7.0, 1.0, 0.0}));
  EXPECT_EQ(filter_.state.gyro_bias, initial_.state.gyro_bias);
  EXPECT_EQ(filter_.state.accel_bias, initial_.state.accel_bias);
  EXPECT_EQ(filter_.state.gravity, initial_.state.gravity);
  const double found = config_.found_sigma_mps * config_.found_sigma_mps;
  EXPECT_TRUE(velocity_covariance().isApprox(found * Eigen::Matrix3d::Identity()));
  EXPECT_EQ(filter_.covariance(I::kGyroBias, I::kGyroBias), 0.01) << "as unsure as at the start";
}

TEST_F(Search, AlongAFreeDirectionTheVelocityStaysUnknown) {
  const Eigen::Vector3d along = Eigen::Vector3d{1.0, 2.0, 0.0}.normalized();
  search_.fused({.fused = true, .free_translations = 1, .free_direction = along}, filter_);
  EXPECT_NEAR(along.dot(velocity_covariance() * along), 64.0, 1e-9);
  const Eigen::Vector3d across = Eigen::Vector3d{2.0, -1.0, 0.0}.normalized();
  EXPECT_NEAR(across.dot(velocity_covariance() * across), config_.found_sigma_mps * config_.found_sigma_mps, 1e-9);
}

TEST_F(Search, WithTwoFreeDirectionsNothingIsFound) {
  search_.fused({.fused = true, .free_translations = 2, .free_direction = Eigen::Vector3d::UnitX()}, filter_);
  EXPECT_TRUE(velocity_covariance().isApprox(64.0 * Eigen::Matrix3d::Identity()));
}

TEST_F(Search, WithEveryScanOfUnknownVelocityTheMapBeginsAnew) {
  for (std::uint32_t i = 0; i < config_.scans; ++i) {
    EXPECT_TRUE(search_.fused({.fused = true}, filter_)) << "scan " << i;
    EXPECT_TRUE(search_.is_on());
  }
  EXPECT_FALSE(search_.fused({.fused = true}, filter_)) << "the first of a round";
}

TEST_F(Search, ItEndsAfterTheLeastRoundsWhenNothingIsLeftToCorrect) {
  find_velocity();
  for (std::uint32_t i = 1; i < config_.least_rounds; ++i) {
    EXPECT_TRUE(round(settled())) << "the map begins anew after every round";
    EXPECT_TRUE(search_.is_on());
  }
  EXPECT_TRUE(round(settled()));
  EXPECT_FALSE(search_.is_on());
  EXPECT_FALSE(search_.is_overdue(initial_.time + std::chrono::hours{1}));
}

TEST_F(Search, ARoundThatCorrectedTheVelocityIsNotTheLast) {
  find_velocity();
  UpdateSummary update = settled();
  update.corrected_mps.y() = 1.1 * config_.settled_mps / config_.round_scans;
  for (std::uint32_t i = 0; i < 3 * config_.least_rounds; ++i) round(update);
  EXPECT_TRUE(search_.is_on());
  round(settled());
  EXPECT_FALSE(search_.is_on());
}

TEST_F(Search, ARoundThatContradictsItsMapIsNotTheLast) {
  find_velocity();
  UpdateSummary update = settled();
  update.test_ratio = 1.1 * config_.settled_test_ratio;
  for (std::uint32_t i = 0; i < 3 * config_.least_rounds; ++i) round(update);
  EXPECT_TRUE(search_.is_on());
}

TEST_F(Search, ARoundWhoseMapWasGivenUpIsCountedAnew) {
  find_velocity();
  for (std::uint32_t i = 1; i < config_.round_scans; ++i) search_.fused(settled(), filter_);
  search_.begin_round();
  EXPECT_FALSE(search_.fused(settled(), filter_));
}

TEST_F(Search, WithinARoundTheFilterKeepsWhatItLearns) {
  find_velocity();
  filter_.state.gyro_bias = {0.01, 0.02, 0.03};
  const FilterSnapshot learnt = filter_;
  search_.fused({.fused = true}, filter_);
  EXPECT_EQ(filter_.state.gyro_bias, learnt.state.gyro_bias);
  EXPECT_EQ(filter_.covariance, learnt.covariance);
}

TEST_F(Search, AfterARoundThatWasNotTheLastItKeepsTheEstimateButNotTheConfidence) {
  find_velocity();
  filter_.state.gyro_bias = {0.01, 0.02, 0.03};
  filter_.covariance *= 1e-6;
  round(settled());
  EXPECT_EQ(filter_.state.gyro_bias, (Eigen::Vector3d{0.01, 0.02, 0.03}));
  EXPECT_NEAR(filter_.covariance(I::kVelocity, I::kVelocity), std::pow(config_.round_sigma_mps, 2), 1e-12);
  EXPECT_NEAR(filter_.covariance(I::kGyroBias, I::kGyroBias), std::pow(config_.round_gyro_bias_rads, 2), 1e-12);
  EXPECT_EQ(filter_.covariance(I::kGravity, I::kGravity), initial_.covariance(I::kGravity, I::kGravity));
}

TEST_F(Search, WithoutAnImuNothingSettles) {
  search_.begin({.filter = initial_, .with_imu = false});
  find_velocity();
  EXPECT_FALSE(search_.is_on());
}

TEST_F(Search, ItIsOverdueAfterItsLimit) {
  EXPECT_FALSE(search_.is_overdue(initial_.time + from_seconds(config_.limit_s)));
  EXPECT_TRUE(search_.is_overdue(initial_.time + from_seconds(config_.limit_s + 0.1)));
  search_.end();
  EXPECT_FALSE(search_.is_overdue(initial_.time + from_seconds(config_.limit_s + 0.1)));
}

}  // namespace
}  // namespace slamd
