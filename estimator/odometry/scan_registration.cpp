#include "estimator/odometry/scan_registration.hpp"

namespace slamd {

namespace {

constexpr std::size_t kMaxKnots = 4'096;
constexpr int kPassesAlone = 3;   // each de-skews by the motion that the one before found
// Mean squared normalised residual. Alone, what the pose agrees with least is a map of poses that were wrong: on such a map
// the next pose is as wrong and sure of it. Good drives stay below 5 from their first metre on.
constexpr double kMostTestRatioAlone = 6.0;

/// Where no IMU holds the prior every iteration associates anew.
IeskfConfig without_imu(IeskfConfig config) {
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

UpdateSummary ScanRegistration::update(const Scan& scan, bool alone, bool after_gap, FilterSnapshot& filter,
                                       StageListener* listener) {
  // A prior that is off by more went wrong before this scan, and says nothing of the motion during it.
  constexpr double kMostSigma_m = 0.3;
  const auto position = filter.covariance.block<3, 3>(ErrorIndex::kPosition, ErrorIndex::kPosition);
  const bool sure = position.trace() < kMostSigma_m * kMostSigma_m;
  if (!alone) {
    IeskfConfig config = config_.update;
    if (after_gap) config.unsure_sigma_m = config_.skewed_sigma_m;
    return pass(scan, config, filter, listener);
  }
  const FilterSnapshot prior = filter;
  UpdateSummary summary = pass(scan, sure ? without_imu(config_.update) : config_.update, filter, listener);
  for (int i = 1; sure && summary.fused && i < kPassesAlone; ++i) {
    filter = prior;
    summary = pass(scan, without_imu(config_.update), filter, listener);
  }
  if (summary.fused && summary.test_ratio > kMostTestRatioAlone) {
    filter = prior;
    summary.fused = false;
  }
  return summary;
}

UpdateSummary ScanRegistration::pass(const Scan& scan, const IeskfConfig& config, FilterSnapshot& filter,
                                     StageListener* listener) {
  const UpdateSummary summary = slamd::update(config, chosen_, residuals_, map_, filter, listener);
  if (summary.fused) {
    motion_.bend(motion_.end().inverse() * filter.state.T_odom_imu());
    deskew(scan, filter.state.T_imu_lidar);
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
