#pragma once
// The front end in the plane: wheels, IMU and scans in, one pose a scan and keyframes out, in `odom`, which never jumps. Loops
// and the map are planar_mapper's.

#include <optional>

#include "estimator/grid/correlative_matcher.hpp"
#include "estimator/grid/line_matcher.hpp"
#include "estimator/grid/local_map.hpp"
#include "estimator/grid/motion_prior.hpp"
#include "estimator/grid/scan_2d.hpp"
#include "estimator/grid/tilt.hpp"
#include "estimator/types/nav_state.hpp"

namespace slamd {

struct PlanarOdometryConfig {
  Scan2dConfig scan;
  TiltConfig tilt;
  MotionPriorConfig motion;
  LocalMapConfig local_map;
  LineMatcherConfig matcher;
  double sure_sigma_m = 0.1;          // a prior that is surer, and whose scan fits at once,
  double sure_sigma_rad = 0.03;
  double sure_inlier_share = 0.4;     // with so much of it on walls, needs no search
  double search_sigmas = 3.0;         // of the prior: half width of the correlative search
  double least_search_m = 0.1;
  double most_search_m = 0.5;
  double most_search_rad = 0.25;
  std::size_t search_points = 150;    // of a scan, at most
  int search_looks = 6000;            // bounds the time of a search
  double search_centre_share = 0.1;   // score that the edge of the search has to gain over the prior
  double least_score = 0.3;           // of the search: with less the scan does not fit
  double least_inlier_share = 0.2;    // of a scan's points; with less it is not believed
  int max_unmatched = 10;             // scans in a row; then a new local map is begun where the prior says
  double keyframe_distance_m = 0.25;  // at least; and
  double keyframe_ranges = 0.04;      // likewise in mean ranges of the scan
  double keyframe_angle_rad = 0.15;
  double drift_m_rtm = 0.002;         // random walk of the local map besides what matching tells
  double drift_rad_rtm = 0.0005;
  double lost_s = 5.0;                // without a scan that fits
};

/// What the back end gets every few decimetres.
struct PlanarKeyframe {
  std::uint64_t id = 0;  // counts from 0 without gaps
  PlanarPose T_odom_base;
  /// Of the pose in the previous keyframe's base, by right perturbation: only what adds up over keyframes.
  Eigen::Matrix3d relative_covariance = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d match_covariance = Eigen::Matrix3d::Zero();  // of this scan in the local map: does not add up
  double inlier_share = 1.0;  // of the scan's points on walls of the local map
  PlanarScan scan;
};

struct PlanarResult {
  NavState state;              // of the scan's end; z, roll and pitch are 0, their sigma is what is known of the lean
  LineMatch match;
  bool is_keyframe = false;    // then PlanarOdometry::keyframe() holds it until the next scan
};

struct PlanarOdometryStats {
  std::uint64_t scans = 0, unmatched = 0, out_of_order = 0, empty = 0;
};

class PlanarOdometry {
 public:
  PlanarOdometry(const VehicleGeometry& vehicle, const PlanarOdometryConfig& config);

  void add(const WheelOdometry& wheels) { prior_.add(wheels); }
  void add(const ImuSample& sample);
  /// Scans in order of time; nullptr: not used (no returns, or not later than the one before; counted). What it points to
  /// holds until the next call.
  const PlanarResult* add(const LaserScan& scan);
  const PlanarResult* add(const Scan& scan);

  const PlanarKeyframe& keyframe() const { return keyframe_; }
  const PlanarOdometryStats& stats() const { return stats_; }

 private:
  const PlanarResult* step();
  LineMatch match(const PlanarPrior& prior);
  bool is_sure(const PlanarPrior& prior) const;
  PlanarPose search(const PlanarPrior& prior);
  void begin_map();
  void take_keyframe(double way_m);
  void tell(const LineMatch& match);

  PlanarOdometryConfig config_;
  Scan2d scan_2d_;
  Tilt tilt_;
  MotionPrior prior_;
  LocalMap map_;
  CorrelativeMatcher correlative_;
  PlanarScan scan_;
  std::vector<Eigen::Vector2f> sample_;     // points of the search
  PlanarKeyframe keyframe_;
  PlanarResult result_;
  PlanarOdometryStats stats_;
  std::uint64_t keyframes_ = 0;
  Eigen::Matrix3d drift_ = Eigen::Matrix3d::Zero();  // of the last keyframe in odom, by right perturbation
  HostTime matched_{};                               // the newest scan that fitted
  int unmatched_ = 0;                                // since then
};

}  // namespace slamd
