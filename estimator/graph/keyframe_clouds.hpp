#pragma once
// The thinned points of every keyframe, from which sub-maps for closing loops are put together. Not the map that clients
// get: that one is daemon/store.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "estimator/graph/odometry_chain.hpp"
#include "estimator/types/point_cloud.hpp"

namespace slamd {

struct KeyframeCloudsConfig {
  float voxel_size_m = 0.5F;
  float max_range_m = 60.0F;  // beyond, a VLP-16's rings are too far apart to make surfaces
};

/// Points around one keyframe, its own and its neighbours', in the centre's level frame: origin at its base, z against
/// gravity, x ahead.
struct Submap {
  std::size_t centre = 0;
  Pose T_level_base;                         // of the centre
  std::vector<Eigen::Vector3f> points;       // level frame, metres
  std::vector<Eigen::Vector3f> viewpoints;   // where the LiDAR stood, level frame, metres, one a keyframe
  std::vector<std::uint32_t> first_points;   // index of each viewpoint's first point
};

class KeyframeClouds {
 public:
  /// p_base_lidar  where the rays begin, base frame, metres
  KeyframeClouds(const KeyframeCloudsConfig& config, const Eigen::Vector3d& p_base_lidar)
      : config_{config}, p_base_lidar_{p_base_lidar} {}

  /// The next keyframe's points, base frame, metres: the first in each voxel is kept, 6 bytes each.
  void add(const PointCloud& points_base);
  std::size_t size() const { return clouds_.size(); }
  std::size_t bytes() const { return bytes_; }

  /// The keyframes centre - behind .. centre + ahead, as far as they exist.
  Submap submap(const OdometryChain& chain, std::size_t centre, std::size_t behind, std::size_t ahead) const;

 private:
  using PackedPoint = std::array<std::int16_t, 3>;

  KeyframeCloudsConfig config_;
  Eigen::Vector3d p_base_lidar_;
  std::vector<std::vector<PackedPoint>> clouds_;
  std::size_t bytes_ = 0;
};

/// The yaw-only part of T: same origin, z against gravity where T's parent frame has it so.
Pose level(const Pose& T);

}  // namespace slamd
