#pragma once
// The odometry's local map: voxels of the incremental k-d tree with the moments of all that fell into them, and the
// plane through each neighbourhood, kept until the neighbourhood has changed. Not the map that clients get.

#include <Eigen/Core>
#include <array>
#include <vector>

#include "estimator/map/ikd_tree.hpp"
#include "estimator/types/pose.hpp"

namespace slamd {

/// The voxels around a place that make its plane.
struct Neighbourhood {
  std::uint32_t voxels;
  float radius_m;
};

struct PlaneMapConfig {
  float voxel_size_m = 0.6F;
  std::uint32_t max_voxels = 200'000;     // within the LiDAR's reach a street has 50,000 to 130,000
  float max_distance_m = 110.0F;     // half the cube that is kept around the vehicle (the LiDAR's reach); less when nearly full
  float min_distance_m = 80.0F;
  float viewpoint_distance_m = 0.3F;  // a place further from the last one, or turned further, sees something new
  float viewpoint_angle_rad = 0.1F;
  Neighbourhood near{5, 1.4F};
  Neighbourhood wide{16, 2.5F};      // tried where the near one does not fix the tilt: one ring is a line, two are a plane
  float near_tilt_rad = 0.04F;
  float max_tilt_rad = 0.05F;         // standard deviation of a normal beyond which a plane is none
  std::uint32_t max_voxel_weight = 100;   // a voxel is frozen when it holds so many points: the old map anchors the new
  std::uint32_t min_plane_points = 6;
  float max_plane_thickness_m = 0.15F;   // RMS distance of the points from their plane
  float min_plane_extent_m = 0.12F;      // RMS extent along the narrower side
};

/// A plane through the points near a place: normal^T (p - centre) = 0.
struct Plane {
  Eigen::Vector3f centre;      // odom, m
  Eigen::Vector3f normal;      // odom, unit
  Eigen::Vector3f axis_major;  // odom, unit, in the plane
  float variance_m2 = 0.0F;    // of the points along the normal
  float major_m2 = 0.0F;       // variances along the plane's own axes
  float minor_m2 = 0.0F;
  float points = 0.0F;

  /// Variance of the plane's height at p, from its points' noise: grows outside of them. m^2.
  float height_variance(const Eigen::Vector3f& p) const;
  /// The noise of the normal: independent tilts of these variances (rad^2) towards two axes in the plane.
  struct Tilt {
    Eigen::Vector3f towards;
    float variance;
  };
  std::array<Tilt, 2> tilts() const;
  /// Variance of the normal's tilt about the worse axis, rad^2.
  float tilt_variance() const { return variance_m2 / (points * minor_m2); }
};

class PlaneMap {
 public:
  explicit PlaneMap(const PlaneMapConfig& config);

  /// Adds a point in odom, metres. Cost: one descent of the tree.
  void insert(const Eigen::Vector3f& p_odom);
  /// The plane near p, or null where the surface is not plane, unknown or too thin. Valid until the next insert.
  const Plane* plane_at(const Eigen::Vector3f& p_odom);
  /// Once a scan: forgets what is far from the vehicle, re-balances with bounded work. Says whether this is a new viewpoint:
  /// scans of one place that follow each other agree on whatever wrong pose the first few had, and are best left out.
  bool maintain(const Pose& T_odom_lidar);
  void clear();

  std::size_t size() const { return tree_.size(); }
  /// From which the map was seen.
  std::uint32_t viewpoints() const { return viewpoints_; }
  const IkdTree& tree() const { return tree_; }

 private:
  struct Moments {                 // about the voxel's first point, so that float suffices
    float count = 0.0F;
    float sum[3] = {};
    float square[6] = {};          // xx xy xz yy yz zz
  };
  struct CachedPlane {
    Plane plane;
    std::uint32_t slot = kNoSlot;  // whose plane this is; slots far apart share an entry
    float voxel_count = 0.0F;      // of the voxel at the time of the fit
    std::uint32_t fitted_at = 0;   // scan
    bool valid = false;
  };

  CachedPlane& cached_plane(std::uint32_t slot) { return planes_[slot % planes_.size()]; }
  bool is_fresh(const CachedPlane& cached, std::uint32_t slot) const;
  void fit(std::uint32_t slot, CachedPlane& cached);
  bool fit(std::uint32_t slot, const Neighbourhood& neighbourhood, Plane& plane) const;

  PlaneMapConfig config_;
  float reach_m_;
  IkdTree tree_;
  std::vector<Moments> moments_;
  std::vector<CachedPlane> planes_;   // of the slots used last: entry slot % size
  std::uint32_t scan_ = 0;
  std::uint32_t viewpoints_ = 0;
  Pose last_viewpoint_;
};

}  // namespace slamd
