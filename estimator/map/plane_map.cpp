#include "estimator/map/plane_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <limits>

namespace slamd {

namespace {

constexpr std::uint32_t kRebalanceWork = 2'000;
constexpr std::uint32_t kRemovalWork = 2'000;
constexpr std::uint32_t kMaxPlaneAge = 10;     // scans
constexpr float kRefitGrowth = 1.15F;
constexpr std::size_t kMostNeighbours = 16;
constexpr std::size_t kCachedPlanes = 1U << 17;  // more than the voxels within the LiDAR's reach that have planes

double squared(double x) { return x * x; }

}  // namespace

float Plane::height_variance(const Eigen::Vector3f& p) const {
  const Eigen::Vector3f d = p - centre;
  const float along_major = axis_major.dot(d);
  const float along_minor = axis_major.cross(normal).dot(d);
  return variance_m2 / points * (1.0F + along_major * along_major / major_m2 + along_minor * along_minor / minor_m2);
}

std::array<Plane::Tilt, 2> Plane::tilts() const {
  return {{{axis_major, variance_m2 / (points * major_m2)}, {axis_major.cross(normal), tilt_variance()}}};
}

PlaneMap::PlaneMap(const PlaneMapConfig& config)
    : config_{config},
      reach_m_{config.max_distance_m},
      tree_{IkdTreeConfig{.voxel_size_m = config.voxel_size_m, .max_points = config.max_voxels}},
      moments_(config.max_voxels),
      planes_(std::min<std::size_t>(config.max_voxels, kCachedPlanes)) {}

void PlaneMap::insert(const Eigen::Vector3f& p_odom) {
  const IkdTree::Insertion insertion = tree_.insert(p_odom);
  if (insertion.slot == kNoSlot) return;
  Moments& m = moments_[insertion.slot];
  if (insertion.is_new) {
    m = {};
    cached_plane(insertion.slot).slot = kNoSlot;
  }
  if (m.count >= static_cast<float>(config_.max_voxel_weight)) return;
  const Eigen::Vector3f d = p_odom - tree_.point(insertion.slot);
  m.count += 1.0F;
  int k = 0;
  for (int i = 0; i < 3; ++i) {
    m.sum[i] += d[i];
    for (int j = i; j < 3; ++j) m.square[k++] += d[i] * d[j];
  }
}

const Plane* PlaneMap::plane_at(const Eigen::Vector3f& p_odom) {
  std::uint32_t slot = tree_.find_voxel(p_odom);
  if (slot == kNoSlot) {
    Neighbour nearest{};
    if (tree_.nearest(p_odom, {&nearest, 1}, config_.near.radius_m) == 0) return nullptr;
    slot = nearest.slot;
  }
  CachedPlane& cached = cached_plane(slot);
  if (!is_fresh(cached, slot)) fit(slot, cached);
  return cached.valid ? &cached.plane : nullptr;
}

bool PlaneMap::is_fresh(const CachedPlane& cached, std::uint32_t slot) const {
  if (cached.slot != slot || moments_[slot].count > kRefitGrowth * cached.voxel_count) return false;
  // Where there was no plane, the neighbours may have grown one: only a plane settles.
  const bool settled = cached.valid && moments_[slot].count >= static_cast<float>(config_.max_voxel_weight);
  return settled || scan_ - cached.fitted_at < kMaxPlaneAge;
}

void PlaneMap::fit(std::uint32_t slot, CachedPlane& cached) {
  cached.slot = slot;
  cached.voxel_count = moments_[slot].count;
  cached.fitted_at = scan_;
  cached.valid = fit(slot, config_.near, cached.plane);
  if (!cached.valid || cached.plane.tilt_variance() > config_.near_tilt_rad * config_.near_tilt_rad) {
    Plane wide;
    if (fit(slot, config_.wide, wide)) {
      cached.plane = wide;
      cached.valid = true;
    }
  }
}

/// False when the points around the slot are no plane.
bool PlaneMap::fit(std::uint32_t slot, const Neighbourhood& neighbourhood, Plane& plane) const {
  std::array<Neighbour, kMostNeighbours> neighbours;
  const Eigen::Vector3f origin = tree_.point(slot);
  const std::size_t most = std::min<std::size_t>(neighbourhood.voxels, kMostNeighbours);
  const std::size_t found = tree_.nearest(origin, {neighbours.data(), most}, neighbourhood.radius_m);
  double count = 0.0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < found; ++i) {
    const Moments& m = moments_[neighbours[i].slot];
    const Eigen::Vector3d d = (tree_.point(neighbours[i].slot) - origin).cast<double>();
    const Eigen::Vector3d s{m.sum[0], m.sum[1], m.sum[2]};
    Eigen::Matrix3d q;
    q << m.square[0], m.square[1], m.square[2], m.square[1], m.square[3], m.square[4], m.square[2], m.square[4],
        m.square[5];
    square += q + s * d.transpose() + d * s.transpose() + m.count * d * d.transpose();
    sum += s + m.count * d;
    count += m.count;
  }
  if (count < config_.min_plane_points) return false;
  const Eigen::Vector3d mean = sum / count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(square / count - mean * mean.transpose());
  const Eigen::Vector3d variance = solver.eigenvalues().cwiseMax(1e-8);
  if (variance[0] > squared(config_.max_plane_thickness_m) || variance[1] < squared(config_.min_plane_extent_m)) {
    return false;
  }
  plane = {origin + mean.cast<float>(),
           solver.eigenvectors().col(0).cast<float>(),
           solver.eigenvectors().col(2).cast<float>(),
           static_cast<float>(variance[0]),
           static_cast<float>(variance[2]),
           static_cast<float>(variance[1]),
           static_cast<float>(count)};
  return plane.tilt_variance() < squared(config_.max_tilt_rad);
}

bool PlaneMap::maintain(const Pose& T_odom_lidar) {
  constexpr float kNearlyFull = 0.9F;
  constexpr float kShrink = 0.98F;
  constexpr float kGrow = 1.002F;
  ++scan_;
  const Pose moved = last_viewpoint_.inverse() * T_odom_lidar;
  const bool is_new = viewpoints_ == 0 || moved.translation.norm() >= config_.viewpoint_distance_m ||
                      moved.rotation.angularDistance(Eigen::Quaterniond::Identity()) >= config_.viewpoint_angle_rad;
  if (is_new) {
    ++viewpoints_;
    last_viewpoint_ = T_odom_lidar;
  }
  tree_.rebalance(kRebalanceWork);
  const bool nearly_full = static_cast<float>(tree_.size()) > kNearlyFull * static_cast<float>(config_.max_voxels);
  reach_m_ = std::clamp(reach_m_ * (nearly_full ? kShrink : kGrow), config_.min_distance_m, config_.max_distance_m);
  const Eigen::Vector3f reach = Eigen::Vector3f::Constant(reach_m_);
  const Eigen::Vector3f p_odom_lidar = T_odom_lidar.translation.cast<float>();
  tree_.remove_outside({p_odom_lidar - reach, p_odom_lidar + reach}, kRemovalWork);
  return is_new;
}

void PlaneMap::clear() {
  const Eigen::Vector3f everywhere = Eigen::Vector3f::Constant(std::numeric_limits<float>::max());
  tree_.remove_box({-everywhere, everywhere}, kRemovalWork);
  viewpoints_ = 0;
}

}  // namespace slamd
