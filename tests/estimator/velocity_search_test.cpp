#include "estimator/odometry/velocity_search.hpp"

#include <gtest/gtest.h>

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

TEST_F(Search, WithEveryScanOfUnknownVelocityTheMapBeginsAnewAndOnceMoreWhenAllHasSettled) {
  const std::uint32_t last = config_.scans + config_.settling_scans - 1;
  for (std::uint32_t i = 0; i <= last; ++i) {
    EXPECT_TRUE(search_.is_on());
    EXPECT_EQ(search_.fused({.fused = true}, filter_), i < config_.scans || i == last) << "scan " << i;
  }
  EXPECT_FALSE(search_.is_on());
  EXPECT_FALSE(search_.is_overdue(initial_.time + std::chrono::hours{1}));
}

TEST_F(Search, WhileItSettlesTheFilterKeepsWhatItLearns) {
  for (std::uint32_t i = 0; i < config_.scans; ++i) search_.fused({.fused = true}, filter_);
  filter_.state.gyro_bias = {0.01, 0.02, 0.03};
  const FilterSnapshot learnt = filter_;
  search_.fused({.fused = true}, filter_);
  EXPECT_EQ(filter_.state.gyro_bias, learnt.state.gyro_bias);
  EXPECT_EQ(filter_.covariance, learnt.covariance);
}

TEST_F(Search, ItIsOverdueAfterItsLimit) {
  EXPECT_FALSE(search_.is_overdue(initial_.time + from_seconds(config_.limit_s)));
  EXPECT_TRUE(search_.is_overdue(initial_.time + from_seconds(config_.limit_s + 0.1)));
  search_.end();
  EXPECT_FALSE(search_.is_overdue(initial_.time + from_seconds(config_.limit_s + 0.1)));
}

}  // namespace
}  // namespace slamd
