#include "estimator/odometry/keyframe_picker.hpp"

#include "estimator/math/lie.hpp"

namespace slamd {

KeyframePicker::KeyframePicker(const KeyframeConfig& config, std::size_t max_points) : config_{config} {
  points_.reserve(max_points);
}

bool KeyframePicker::is_due(const Pose& T_odom_base) const {
  if (!T_odom_last_) return true;
  const Pose T_last_base = T_odom_last_->inverse() * T_odom_base;
  return T_last_base.translation.norm() >= config_.distance_m || log_so3(T_last_base.rotation).norm() >= config_.angle_rad;
}

void KeyframePicker::take(const Scan& scan, const ScanMotion& motion, const Pose& T_base_lidar, const Pose& T_odom_base) {
  T_odom_last_ = T_odom_base;
  points_.clear();
  const Eigen::Matrix3f R = T_base_lidar.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_base_lidar.translation.cast<float>();
  for (const LidarPoint& point : scan.points) {
    const float time_s = static_cast<float>(point.time_offset_ns) * 1e-9F;
    const Eigen::Vector3f p = R * motion.deskew({point.x, point.y, point.z}, time_s) + t;
    points_.push_back({p.x(), p.y(), p.z(), static_cast<float>(point.intensity)});
  }
}

}  // namespace slamd
