#include "estimator/odometry/imu_doubt.hpp"

namespace slamd {

using I = ErrorIndex;

namespace {

bool is_small(const ImuDoubtConfig& config, double correction) {
  return correction <= config.most_correction_sigmas * config.most_correction_sigmas;
}

}  // namespace

bool is_moved(const ImuDoubtConfig& config, const UpdateSummary& update) {
  return update.fused && !(is_small(config, update.attitude_correction) && is_small(config, update.position_correction));
}

bool fits(const UpdateSummary& update, double most_test_ratio) {
  return update.fused && update.test_ratio <= most_test_ratio;
}

bool fits_far_better(const ImuDoubtConfig& config, const UpdateSummary& update, std::uint32_t inliers) {
  return update.fused && update.inliers > config.better_inlier_share * update.matched &&
         update.inliers > config.better_inlier_gain * inliers;
}

void doubt_biases(const ImuDoubtConfig& config, const UpdateSummary& contradiction, FilterSnapshot& filter) {
  const auto forget = [&filter](int row, double sigma) {
    filter.covariance.middleRows<3>(row).setZero();
    filter.covariance.middleCols<3>(row).setZero();
    filter.clone.cross.middleRows<3>(row).setZero();
    filter.covariance.diagonal().segment<3>(row).setConstant(sigma * sigma);
  };
  const bool turn_fits = contradiction.fused && is_small(config, contradiction.attitude_correction);
  if (!turn_fits) {
    forget(I::kGyroBias, config.gyro_bias_rads);
    filter.covariance.diagonal().segment<3>(I::kAttitude).array() += config.attitude_rad * config.attitude_rad;
  }
  forget(I::kAccelBias, config.accel_bias_mps2);
}

}  // namespace slamd
