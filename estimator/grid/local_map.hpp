#pragma once
// The stretch of the drive that new scans are matched against: two maps that overlap by half, so that the older one always
// reaches back far enough. It forgets; what stays is the back end's.

#include <array>

#include "estimator/grid/likelihood_pyramid.hpp"
#include "estimator/grid/line_map.hpp"

namespace slamd {

struct LocalMapConfig {
  LineMapConfig lines;
  LikelihoodConfig likelihood;
  double length_m = 15.0;      // way after which a map is given up, at least; the next one began half that before
  double length_ranges = 6.0;  // likewise in mean ranges of the scans: in a wide world walls stay in sight for longer
  double turn_m = 1.0;      // a turn by a radian counts like this way
};

class LocalMap {
 public:
  explicit LocalMap(const LocalMapConfig& config);

  /// way_m  travelled since the last one
  void add(const PlanarScan& scan, const PlanarPose& T_odom_base, double way_m);
  void clear();

  const LineMap& lines() const { return maps_[0].lines; }
  const LikelihoodPyramid& likelihood() const { return maps_[0].likelihood; }
  bool is_empty() const { return maps_[0].lines.is_empty(); }
  /// Way over which the pose's error is renewed: half a map.
  double renewal_m() const { return 0.5 * length_m_; }
  double turn_m() const { return config_.turn_m; }

 private:
  struct Part {
    LineMap lines;
    LikelihoodPyramid likelihood;
    double way_m = 0.0;  // since it began
    void clear();
  };
  LocalMapConfig config_;
  double length_m_;           // by the newest scan
  std::array<Part, 2> maps_;  // the older first
  bool has_second_ = false;
};

}  // namespace slamd
