#include "estimator/filter/point_to_plane.hpp"

namespace slamd {

using I = ErrorIndex;

PointToPlane::PointToPlane(const PointToPlaneConfig& config, std::size_t max_points) : config_{config} {
  matches_.reserve(max_points);
}

bool PointToPlane::can_be_seen(const Plane& plane, const Eigen::Vector3f& p_odom_lidar) const {
  const Eigen::Vector3f to_plane = plane.centre - p_odom_lidar;
  const float distance_m = std::abs(plane.normal.dot(to_plane));
  return distance_m > std::max(config_.least_view_distance_m, config_.least_view_sine * to_plane.norm());
}

void PointToPlane::associate(std::span<const MeasuredPoint> points, const InertialState& state, PlaneMap& map) {
  matches_.clear();
  const Pose T_odom_lidar = state.T_odom_lidar();
  const Eigen::Matrix3f R = T_odom_lidar.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_odom_lidar.translation.cast<float>();
  for (const MeasuredPoint& point : points) {
    if (matches_.size() == matches_.capacity()) break;
    const Plane* plane = map.plane_at(R * point.p_lidar + t);
    if (plane != nullptr && can_be_seen(*plane, t)) matches_.push_back({point.p_lidar, point.returns, *plane});
  }
}

namespace {

/// Where the sensor was, as matrices, and what a point at one place says of the states.
struct Geometry {
  Eigen::Matrix3d R_odom_imu, R_imu_lidar;
  Eigen::Vector3d t_imu_lidar, p_odom_imu;
  bool with_extrinsic;

  /// d(direction . p_odom)/d(error): linear in `direction` (odom).
  MeasuredVector gradient(const Eigen::Vector3d& p_lidar, const Eigen::Vector3d& p_imu,
                          const Eigen::Vector3d& direction) const {
    MeasuredVector h = MeasuredVector::Zero();
    const Eigen::Vector3d direction_imu = R_odom_imu.transpose() * direction;
    h.segment<3>(I::kAttitude) = p_imu.cross(direction_imu);
    h.segment<3>(I::kPosition) = direction;
    if (with_extrinsic) {
      h.segment<3>(I::kExtrinsicRotation) = p_lidar.cross(R_imu_lidar.transpose() * direction_imu);
      h.segment<3>(I::kExtrinsicTranslation) = direction_imu;
    }
    return h;
  }
};

Geometry geometry(const InertialState& state, bool with_extrinsic) {
  return {state.R_odom_imu.toRotationMatrix(), state.T_imu_lidar.rotation.toRotationMatrix(),
          state.T_imu_lidar.translation, state.p_odom_imu, with_extrinsic};
}

}  // namespace

Linearisation PointToPlane::linearise(const InertialState& state, const Matrix6d& pose_covariance,
                                      bool with_extrinsic) const {
  Linearisation out;
  const Geometry at = geometry(state, with_extrinsic);
  for (const Match& match : matches_) {
    const Eigen::Vector3d p_lidar = match.p_lidar.cast<double>();
    const Eigen::Vector3d p_imu = at.R_imu_lidar * p_lidar + at.t_imu_lidar;
    const Eigen::Vector3d p_odom = at.R_odom_imu * p_imu + at.p_odom_imu;
    const Eigen::Vector3d normal = match.plane.normal.cast<double>();
    const Eigen::Vector3d from_centre = p_odom - match.plane.centre.cast<double>();
    const double residual = normal.dot(from_centre);
    const MeasuredVector h = at.gradient(p_lidar, p_imu, normal);
    const double variance = residual_variance(match, p_odom.cast<float>());
    const double prior_variance = h.head<6>().dot(pose_covariance * h.head<6>());
    const double gate2 = config_.gate_sigmas * config_.gate_sigmas * (variance + prior_variance);
    ++out.matched;
    const double squared = residual * residual;
    out.squared_error += std::min(squared, gate2) / variance;
    if (squared > gate2 || squared > config_.max_residual_m * config_.max_residual_m) continue;
    const double scaled = squared / (config_.robust_scale * config_.robust_scale * (variance + prior_variance));
    const double weight = 1.0 / (variance * (1.0 + scaled));
    ++out.inliers;
    const double faked = weight * match.plane.tilt_variance();
    out.normal_noise += faked;
    out.normal_noise_rotation += faked * p_imu.squaredNorm();
    out.information.noalias() += weight * h * h.transpose();
    out.gradient.noalias() += weight * residual * h;
    // A normal that is tilted by e has added E[h_e h_e^T] and E[h_e (e . from_centre)] on average: information that is not
    // there, and a pull towards the centre, which is where the map's rings are and not where the sensor is.
    for (const Plane::Tilt& tilt : match.plane.tilts()) {
      const Eigen::Vector3d towards = tilt.towards.cast<double>();
      const MeasuredVector h_tilt = at.gradient(p_lidar, p_imu, towards);
      const double share = weight * tilt.variance;
      out.gradient.noalias() -= share * towards.dot(from_centre) * h_tilt;
      if (with_extrinsic) {
        out.information.noalias() -= share * h_tilt * h_tilt.transpose();
      } else {
        out.information.topLeftCorner<6, 6>().noalias() -= share * h_tilt.head<6>() * h_tilt.head<6>().transpose();
      }
    }
  }
  return out;
}

double PointToPlane::residual_variance(const Match& match, const Eigen::Vector3f& p_odom) const {
  const double point = config_.range_sigma_m * config_.range_sigma_m / match.returns;
  return std::max<double>(point, match.plane.variance_m2) + match.plane.height_variance(p_odom) +
         config_.floor_sigma_m * config_.floor_sigma_m;
}

}  // namespace slamd
