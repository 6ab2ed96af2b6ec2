#pragma once
// Point-to-plane residuals of one scan against the map, linearised into the information of the measured error states.

#include <span>
#include <vector>

#include "estimator/filter/inertial_state.hpp"
#include "estimator/map/plane_map.hpp"

namespace slamd {

using MeasuredVector = Eigen::Matrix<double, ErrorIndex::kMeasured, 1>;
using MeasuredMatrix = Eigen::Matrix<double, ErrorIndex::kMeasured, ErrorIndex::kMeasured>;

struct PointToPlaneConfig {
  double range_sigma_m = 0.02;      // one return
  double floor_sigma_m = 0.01;      // of a residual: what averaging cannot remove
  double robust_scale = 2.0;        // standard deviations at which a residual's weight is one half
  double gate_sigmas = 4.0;         // beyond: not used at all
  double max_residual_m = 1.0;
  // No beam comes back from a plane that it runs along. What looks like one is the sweep of one laser across an edge: it
  // moves with the sensor.
  float least_view_distance_m = 0.5F;  // of the sensor from the plane
  float least_view_sine = 0.03F;      // of the angle between beam and plane
};

/// A de-skewed point: lidar frame at scan end, metres.
struct MeasuredPoint {
  Eigen::Vector3f p_lidar;
  float returns = 1.0F;
};

struct Linearisation {
  MeasuredMatrix information = MeasuredMatrix::Zero();  // sum w h h^T, less what noise in the normals fakes
  MeasuredVector gradient = MeasuredVector::Zero();     // sum w h r
  double normal_noise = 0.0;    // sum w (tilt variance): information on position that noise in the normals would fake
  double normal_noise_rotation = 0.0;  // likewise on attitude, sum w (tilt variance) |p|^2
  double squared_error = 0.0;   // sum of (r / sigma)^2 over all matched, not robust; beyond the gate as much as at it
  std::uint32_t matched = 0;    // points with a plane
  std::uint32_t inliers = 0;    // of them inside the gate
};

class PointToPlane {
 public:
  PointToPlane(const PointToPlaneConfig& config, std::size_t max_points);

  /// Finds the plane of every point at `state`. Planes are copied: the map may change afterwards.
  void associate(std::span<const MeasuredPoint> points, const InertialState& state, PlaneMap& map);
  /// Residuals of the associated points at `state`, weighted; pose_covariance (of attitude and position) widens
  /// the gate by what the prior allows.
  Linearisation linearise(const InertialState& state, const Matrix6d& pose_covariance, bool with_extrinsic) const;

 private:
  struct Match {
    Eigen::Vector3f p_lidar;
    float returns;
    Plane plane;
  };
  bool can_be_seen(const Plane& plane, const Eigen::Vector3f& p_odom_lidar) const;
  double residual_variance(const Match& match, const Eigen::Vector3f& p_odom) const;

  PointToPlaneConfig config_;
  std::vector<Match> matches_;
};

}  // namespace slamd
