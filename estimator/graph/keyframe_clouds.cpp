#include "estimator/graph/keyframe_clouds.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace slamd {

namespace {

constexpr float kResolution_m = 0.005F;

std::int64_t voxel_key(const CloudPoint& p, float size_m) {
  const auto cell = [&](float x) { return static_cast<std::int64_t>(std::floor(x / size_m)) & 0x1FFFFF; };
  return cell(p.x) << 42 | cell(p.y) << 21 | cell(p.z);
}

std::int16_t pack(float x_m) { return static_cast<std::int16_t>(std::lround(x_m / kResolution_m)); }

}  // namespace

Pose level(const Pose& T) {
  const Eigen::Vector3d ahead = T.rotation * Eigen::Vector3d::UnitX();
  const double yaw = std::atan2(ahead.y(), ahead.x());
  return {Eigen::Quaterniond{Eigen::AngleAxisd{yaw, Eigen::Vector3d::UnitZ()}}, T.translation};
}

void KeyframeClouds::add(const PointCloud& points_base) {
  std::unordered_set<std::int64_t> voxels;
  voxels.reserve(points_base.size());
  std::vector<PackedPoint> cloud;
  for (const CloudPoint& p : points_base) {
    const float squared_range = p.x * p.x + p.y * p.y + p.z * p.z;
    if (!(squared_range < config_.max_range_m * config_.max_range_m)) continue;
    if (voxels.insert(voxel_key(p, config_.voxel_size_m)).second) cloud.push_back({pack(p.x), pack(p.y), pack(p.z)});
  }
  cloud.shrink_to_fit();
  bytes_ += cloud.size() * sizeof(PackedPoint);
  clouds_.push_back(std::move(cloud));
}

Submap KeyframeClouds::submap(const OdometryChain& chain, std::size_t centre, std::size_t behind,
                              std::size_t ahead) const {
  const Pose T_odom_level = level(chain.T_odom_base(centre));
  Submap result;
  result.centre = centre;
  result.T_level_base = T_odom_level.inverse() * chain.T_odom_base(centre);
  const std::size_t first = centre > behind ? centre - behind : 0;
  const std::size_t last = std::min(centre + ahead, size() - 1);
  for (std::size_t i = first; i <= last; ++i) {
    const Pose T_level_base = T_odom_level.inverse() * chain.T_odom_base(i);
    const Eigen::Matrix3f R = T_level_base.rotation.toRotationMatrix().cast<float>() * kResolution_m;
    const Eigen::Vector3f t = T_level_base.translation.cast<float>();
    result.viewpoints.push_back((T_level_base * p_base_lidar_).cast<float>());
    result.first_points.push_back(static_cast<std::uint32_t>(result.points.size()));
    for (const PackedPoint& p : clouds_[i]) {
      result.points.push_back(R * Eigen::Vector3f{float(p[0]), float(p[1]), float(p[2])} + t);
    }
  }
  return result;
}

}  // namespace slamd
