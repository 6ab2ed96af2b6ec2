#include "estimator/filter/point_to_plane.hpp"

namespace slamd {

using I = ErrorIndex;

PointToPlane::PointToPlane(const PointToPlaneConfig& config, std::size_t max_points) : config_{config} {
  matches_.reserve(max_points);
}

void PointToPlane::associate(std::span<const MeasuredPoint> points, const InertialState& state, PlaneMap& map) {
  matches_.clear();
  const Pose T_odom_lidar = state.T_odom_lidar();
  const Eigen::Matrix3f R = T_odom_lidar.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_odom_lidar.translation.cast<float>();
  for (const MeasuredPoint& point : points) {
    if (matches_.size() == matches_.capacity()) break;
    const Plane* plane = map.plane_at(R * point.p_lidar + t);
    if (plane != nullptr) matches_.push_back({point.p_lidar, point.returns, *plane});
  }
}

Linearisation PointToPlane::linearise(const InertialState& state, const Matrix6d& pose_covariance,
                                      bool with_extrinsic) const {
  Linearisation out;
  const Eigen::Matrix3d R_odom_imu = state.R_odom_imu.toRotationMatrix();
  const Eigen::Matrix3d R_imu_lidar = state.T_imu_lidar.rotation.toRotationMatrix();
  for (const Match& match : matches_) {
    const Eigen::Vector3d p_lidar = match.p_lidar.cast<double>();
    const Eigen::Vector3d p_imu = R_imu_lidar * p_lidar + state.T_imu_lidar.translation;
    const Eigen::Vector3d p_odom = R_odom_imu * p_imu + state.p_odom_imu;
    const Eigen::Vector3d normal = match.plane.normal.cast<double>();
    const double residual = normal.dot(p_odom - match.plane.centre.cast<double>());

    MeasuredVector h = MeasuredVector::Zero();
    const Eigen::Vector3d normal_imu = R_odom_imu.transpose() * normal;
    h.segment<3>(I::kAttitude) = p_imu.cross(normal_imu);
    h.segment<3>(I::kPosition) = normal;
    if (with_extrinsic) {
      h.segment<3>(I::kExtrinsicRotation) = p_lidar.cross(R_imu_lidar.transpose() * normal_imu);
      h.segment<3>(I::kExtrinsicTranslation) = normal_imu;
    }
    const double point_variance = config_.range_sigma_m * config_.range_sigma_m / match.returns;
    const double variance = std::max<double>(point_variance, match.plane.variance_m2) +
                            match.plane.height_variance(p_odom.cast<float>()) +
                            config_.floor_sigma_m * config_.floor_sigma_m;
    const double prior_variance = h.head<6>().dot(pose_covariance * h.head<6>());
    const double gate2 = config_.gate_sigmas * config_.gate_sigmas * (variance + prior_variance);
    ++out.matched;
    const double squared = residual * residual;
    if (squared > gate2 || squared > config_.max_residual_m * config_.max_residual_m) continue;
    const double scaled = squared / (config_.robust_scale * config_.robust_scale * (variance + prior_variance));
    const double weight = 1.0 / (variance * (1.0 + scaled));
    ++out.inliers;
    out.squared_error += squared / variance;
    const double faked = weight * match.plane.tilt_variance();
    out.normal_noise += faked;
    out.normal_noise_rotation += faked * p_imu.squaredNorm();
    out.information.noalias() += weight * h * h.transpose();
    out.gradient.noalias() += weight * residual * h;
  }
  return out;
}

}  // namespace slamd
