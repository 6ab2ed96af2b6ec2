#include "estimator/odometry/scan_registration.hpp"

namespace slamd {

namespace {

constexpr std::size_t kMaxKnots = 4'096;
// Each pass de-skews by the motion that the one before found.
constexpr int kPassesOfGuess = 3;
constexpr int kMostPassesOfBias = 8;
// Mean squared normalised residual. Alone, what the pose agrees with least is a map of poses that were wrong: on such a map
// the next pose is as wrong and sure of it. Good drives stay below 5 from their first metre on.
constexpr double kMostTestRatioAlone = 6.0;

/// Where the prior is a guess every iteration associates anew.
IeskfConfig by_guess(IeskfConfig config) {
  config.associate_again_m = 0.0;
  return config;
}

}  // namespace

ScanRegistration::ScanRegistration(const ScanRegistrationConfig& config)
    : config_{config}, motion_{kMaxKnots}, residuals_{config.point_to_plane, config.max_points}, map_{config.map} {
  deskewed_.reserve(kMaxSegments);
  chosen_.reserve(config.max_points);
}

void ScanRegistration::deskew(const Scan& scan, const Pose& T_imu_lidar) {
  motion_.finish(T_imu_lidar);
  deskewed_.clear();
  const std::size_t all = std::min(scan.segments.size(), deskewed_.capacity());
  const std::size_t some = share_of(all);
  for (std::size_t i = 0; i < some; ++i) {
    const ScanSegment& segment = scan.segments[i * all / some];
    deskewed_.push_back({motion_.deskew({segment.x, segment.y, segment.z}, segment.time_s),
                         static_cast<float>(segment.count)});
  }
  chosen_.clear();
  const std::size_t most = std::min(share_of(config_.max_points), deskewed_.size());
  for (std::size_t i = 0; i < most; ++i) chosen_.push_back(deskewed_[i * deskewed_.size() / most]);
}

std::size_t ScanRegistration::share_of(std::size_t count) const {
  return share_ < 1.0 ? static_cast<std::size_t>(share_ * static_cast<double>(count)) : count;
}

UpdateSummary ScanRegistration::update(const Scan& scan, const PriorMotion& motion, FilterSnapshot& filter,
                                       StageListener* listener) {
  // A prior that is off by more went wrong before this scan, and says nothing of the motion during it.
  constexpr double kMostSigma_m = 0.3;
  // A gyro with a bias less known than this does not tell the turn during a scan as well as the scan itself.
  constexpr double kKnownBias_rads = 2.0e-3;
  const auto variance = [&](int row) { return filter.covariance.diagonal().segment<3>(row).sum(); };
  const bool sure = variance(ErrorIndex::kPosition) < kMostSigma_m * kMostSigma_m;
  const bool biased = !motion.coasted && variance(ErrorIndex::kGyroBias) > 3.0 * kKnownBias_rads * kKnownBias_rads;
  const bool guessed = sure && (motion.coasted || biased);
  IeskfConfig config = guessed ? by_guess(config_.update) : config_.update;
  if (guessed && !motion.alone) config.least_sigma_m = config_.guessed_sigma_m;
  if (motion.after_gap) config.unsure_sigma_m = config_.skewed_sigma_m;
  const FilterSnapshot prior = filter;
  UpdateSummary summary;
  int left = !guessed ? 1 : biased ? kMostPassesOfBias : kPassesOfGuess;
  for (; left > 0; --left) {
    filter = prior;
    summary = slamd::update(config, chosen_, residuals_, map_, filter, listener);
    if (!summary.fused) break;
    // Where the scan's begin is known, an error of rate shows by half in the end: that is its mean over the scan.
    const Pose shown = motion_.end().inverse() * filter.state.T_odom_imu();
    const bool settled = biased && log_so3(shown.rotation).norm() < config.converged_rotation_rad;
    if (settled) left = 1;
    motion_.bend(biased && left > 1 ? shown * shown : shown);
    deskew(scan, filter.state.T_imu_lidar);
  }
  if (motion.alone && summary.fused && summary.test_ratio > kMostTestRatioAlone) {
    filter = prior;
    summary.fused = false;
  }
  return summary;
}

void ScanRegistration::insert(const InertialState& state) {
  const Pose T_odom_lidar = state.T_odom_lidar();
  const Eigen::Matrix3f R = T_odom_lidar.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_odom_lidar.translation.cast<float>();
  if (!map_.maintain(T_odom_lidar)) return;
  for (const MeasuredPoint& point : deskewed_) map_.insert(R * point.p_lidar + t);
}

}  // namespace slamd
