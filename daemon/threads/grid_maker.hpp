#pragma once
// Keeps the occupancy grid up to date: new keyframes are added as they come; after a correction it is made anew in small
// portions, while the old one goes on. It owns no thread.

#include "estimator/grid/occupancy_builder.hpp"
#include "estimator/grid/planar_mapper.hpp"

namespace slamd {

class GridMaker {
 public:
  explicit GridMaker(const OccupancyConfig& config) : shown_{config}, next_{config} {}

  /// The newest keyframe of the map.
  void add(const PlanarScan& scan, const PlanarPose& T_map_base);
  /// Keyframes have moved: all is to be made anew.
  void corrected() { is_outdated_ = true; }
  void clear();
  /// One portion of making it anew. False: there was nothing to do.
  bool work(const PlanarMapper& mapper);

  /// Whether a snapshot would be another one than the last.
  bool has_changed() const { return has_changed_; }
  OccupancyGrid snapshot();

 private:
  OccupancyBuilder shown_, next_;
  std::size_t done_ = 0;       // keyframes in next_
  bool is_making_ = false;     // next_ is being made
  bool is_outdated_ = false;
  bool has_changed_ = false;
};

}  // namespace slamd
