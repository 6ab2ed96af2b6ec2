#include "estimator/grid/local_map.hpp"

#include <algorithm>

namespace slamd {

LocalMap::LocalMap(const LocalMapConfig& config)
    : config_{config},
      length_m_{config.length_m},
      maps_{Part{LineMap{config.lines}, LikelihoodPyramid{config.likelihood}},
            Part{LineMap{config.lines}, LikelihoodPyramid{config.likelihood}}} {}

void LocalMap::Part::clear() {
  lines.clear();
  likelihood.clear();
  way_m = 0.0;
}

void LocalMap::add(const PlanarScan& scan, const PlanarPose& T_odom_base, double way_m) {
  length_m_ = std::max<double>(config_.length_m, config_.length_ranges * scan.mean_range_m);
  for (Part& part : maps_) part.way_m += way_m;
  if (maps_[0].way_m >= length_m_ && has_second_) {
    std::swap(maps_[0], maps_[1]);
    maps_[1].clear();
  }
  has_second_ = maps_[0].way_m >= 0.5 * length_m_;
  if (!has_second_) maps_[1].way_m = 0.0;
  for (std::size_t i = 0; i < (has_second_ ? 2U : 1U); ++i) {
    maps_[i].lines.add(scan, T_odom_base);
    maps_[i].likelihood.add(scan.points, T_odom_base);
  }
}

void LocalMap::clear() {
  for (Part& part : maps_) part.clear();
  has_second_ = false;
}

}  // namespace slamd
