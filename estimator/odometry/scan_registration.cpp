#include "estimator/odometry/scan_registration.hpp"

namespace slamd {

namespace {

constexpr std::size_t kMaxKnots = 4'096;

}  // namespace

ScanRegistration::ScanRegistration(const ScanRegistrationConfig& config)
    : config_{config}, motion_{kMaxKnots}, residuals_{config.point_to_plane, config.max_points}, map_{config.map} {
  deskewed_.reserve(kMaxSegments);
  chosen_.reserve(config.max_points);
}

void ScanRegistration::deskew(const Scan& scan, const Pose& T_imu_lidar) {
  motion_.finish(T_imu_lidar);
  deskewed_.clear();
  for (const ScanSegment& segment : scan.segments) {
    if (deskewed_.size() == deskewed_.capacity()) break;
    deskewed_.push_back({motion_.deskew({segment.x, segment.y, segment.z}, segment.time_s),
                         static_cast<float>(segment.count)});
  }
  chosen_.clear();
  const std::size_t most = std::min<std::size_t>(config_.max_points, deskewed_.size());
  for (std::size_t i = 0; i < most; ++i) chosen_.push_back(deskewed_[i * deskewed_.size() / most]);
}

UpdateSummary ScanRegistration::update(const Scan& scan, FilterSnapshot& filter, StageListener* listener) {
  const Pose T_odom_prior = filter.state.T_odom_imu();
  const UpdateSummary summary = slamd::update(config_.update, chosen_, residuals_, map_, filter, listener);
  if (summary.fused) {
    motion_.bend(T_odom_prior.inverse() * filter.state.T_odom_imu());
    deskew(scan, filter.state.T_imu_lidar);
  }
  return summary;
}

void ScanRegistration::insert(const InertialState& state) {
  const Pose T_odom_lidar = state.T_odom_lidar();
  const Eigen::Matrix3f R = T_odom_lidar.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_odom_lidar.translation.cast<float>();
  map_.maintain(t);
  for (const MeasuredPoint& point : deskewed_) map_.insert(R * point.p_lidar + t);
}

}  // namespace slamd
