#pragma once
// The thinned points of every keyframe, from which sub-maps for closing loops are put together. Not the map that clients
// get: that one is daemon/store.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "estimator/graph/odometry_chain.hpp"
#include "estimator/graph/packed_cloud.hpp"

namespace slamd {

struct KeyframeCloudsConfig {
  CloudGrid grid;  // beyond its reach a VLP-16's rings are too far apart to make surfaces
  std::uint32_t every = 2;  // of so many keyframes one keeps its points: they overlap by far more than sub-maps need
  std::size_t byte_budget = 256U * 1024 * 1024;  // beyond it the points of the oldest keyframes are forgotten
};

/// Points around one keyframe, its own and its neighbours', in the centre's level frame: origin at its base, z against
/// gravity, x ahead.
struct Submap {
  std::size_t centre = 0;
  Pose T_level_base;                         // of the centre
  std::size_t middle = 0;                    // of its keyframes: not the centre where a drive begins or ends
  Pose T_level_middle;                       // its base
  std::vector<Eigen::Vector3f> points;       // level frame, metres
  std::vector<Eigen::Vector3f> viewpoints;   // where the LiDAR stood, level frame, metres, one a keyframe
  std::vector<std::uint32_t> first_points;   // index of each viewpoint's first point
};

class KeyframeClouds {
 public:
  /// p_base_lidar  where the rays begin, base frame, metres
  KeyframeClouds(const KeyframeCloudsConfig& config, const Eigen::Vector3d& p_base_lidar)
      : config_{config}, p_base_lidar_{p_base_lidar} {}

  /// The next keyframe's points, base frame, metres: of every config.every-th keyframe the first in each voxel is kept.
  void add(const PointCloud& points_base);
  /// Likewise of points that were packed with the same grid before.
  void add_packed(std::vector<std::uint8_t> packed);
  /// Empty for a keyframe whose points were not kept or are forgotten.
  const std::vector<std::uint8_t>& packed(std::size_t i) const { return clouds_[i]; }
  std::size_t size() const { return clouds_.size(); }
  std::size_t bytes() const { return bytes_; }
  /// So many of the oldest keyframes have lost their points for the budget; their sub-maps are empty.
  std::size_t forgotten() const { return forgotten_; }

  /// The keyframes centre - behind .. centre + ahead, as far as they exist.
  Submap submap(const OdometryChain& chain, std::size_t centre, std::size_t behind, std::size_t ahead) const;

 private:
  KeyframeCloudsConfig config_;
  Eigen::Vector3d p_base_lidar_;
  std::vector<std::vector<std::uint8_t>> clouds_;  // packed
  std::size_t bytes_ = 0;
  std::size_t forgotten_ = 0;
};

/// The yaw-only part of T: same origin, z against gravity where T's parent frame has it so.
Pose level(const Pose& T);

}  // namespace slamd
