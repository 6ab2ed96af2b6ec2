#pragma once
// Back-propagation: moves every point from the instant of its firing to the scan's end. Holds the motion, not the points.

#include <vector>

#include "estimator/types/pose.hpp"
#include "estimator/types/scan.hpp"

namespace slamd {

/// The vehicle's motion over one scan as knots in time with constant twist between them.
class ScanMotion {
 public:
  explicit ScanMotion(std::size_t max_knots) {
    knots_.reserve(max_knots);
    pieces_.reserve(max_knots);
  }

  /// Starts anew at a scan's begin.
  void clear() { knots_.clear(); }
  /// T_odom_imu at time_s after the scan's begin, in order of time. The last knot is the scan's end.
  void add(double time_s, const Pose& T_odom_imu);
  /// Corrects the motion once the end is known better: T_odom_end becomes T_odom_end * T_end_corrected, the begin stays,
  /// what is between takes its share in proportion to time. finish() again afterwards.
  void bend(const Pose& T_end_corrected);
  /// T_odom_imu at the scan's end; only after an add().
  const Pose& end() const { return knots_.back().T_odom_imu; }
  /// All that deskew() needs, from the knots. Call after the last add().
  void finish(const Pose& T_imu_lidar);

  /// A point of the lidar frame at time_s to the lidar frame at the scan's end. Rotation to second order in the time from
  /// its knot. Source: Xu et al. 2022, eq. (10).
  Eigen::Vector3f deskew(const Eigen::Vector3f& p_lidar, float time_s) const;

 private:
  struct Knot {
    double time_s;
    Pose T_odom_imu;
  };
  struct Piece {                  // of lidar poses, from its knot to the next
    Eigen::Matrix3f R_end_knot;
    Eigen::Vector3f t_end_knot;
    Eigen::Vector3f rate_rads;       // body rate
    Eigen::Vector3f velocity_mps;    // in the end frame
    float time_s;
  };
  std::vector<Knot> knots_;
  std::vector<Piece> pieces_;
};

}  // namespace slamd
