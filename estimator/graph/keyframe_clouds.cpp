#include "estimator/graph/keyframe_clouds.hpp"

#include <algorithm>
#include <cmath>

namespace slamd {

Pose level(const Pose& T) {
  const Eigen::Vector3d ahead = T.rotation * Eigen::Vector3d::UnitX();
  const double yaw = std::atan2(ahead.y(), ahead.x());
  return {Eigen::Quaterniond{Eigen::AngleAxisd{yaw, Eigen::Vector3d::UnitZ()}}, T.translation};
}

void KeyframeClouds::add(const PointCloud& points_base) {
  const bool counts = size() % config_.every == 0;
  add_packed(counts ? pack_cloud(points_base, config_.grid) : std::vector<std::uint8_t>{});
}

void KeyframeClouds::add_packed(std::vector<std::uint8_t> packed) {
  clouds_.push_back(std::move(packed));
  bytes_ += clouds_.back().size();
  for (; bytes_ > config_.byte_budget && forgotten_ + 1 < clouds_.size(); ++forgotten_) {
    bytes_ -= clouds_[forgotten_].size();
    std::vector<std::uint8_t>{}.swap(clouds_[forgotten_]);
  }
}

Submap KeyframeClouds::submap(const OdometryChain& chain, std::size_t centre, std::size_t behind,
                              std::size_t ahead) const {
  const Pose T_odom_level = level(chain.T_odom_base(centre));
  Submap result;
  result.centre = centre;
  result.T_level_base = T_odom_level.inverse() * chain.T_odom_base(centre);
  const std::size_t first = centre > behind ? centre - behind : 0;
  const std::size_t last = std::min(centre + ahead, size() - 1);
  result.middle = (first + last) / 2;
  result.T_level_middle = T_odom_level.inverse() * chain.T_odom_base(result.middle);
  for (std::size_t i = first; i <= last; ++i) {
    const Pose T_level_base = T_odom_level.inverse() * chain.T_odom_base(i);
    const Eigen::Matrix3f R = T_level_base.rotation.toRotationMatrix().cast<float>();
    const Eigen::Vector3f t = T_level_base.translation.cast<float>();
    result.viewpoints.push_back((T_level_base * p_base_lidar_).cast<float>());
    result.first_points.push_back(static_cast<std::uint32_t>(result.points.size()));
    unpack_cloud(clouds_[i], config_.grid, [&](const Eigen::Vector3f& p) { result.points.push_back(R * p + t); });
  }
  return result;
}

}  // namespace slamd
