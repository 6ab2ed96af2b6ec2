#pragma once
// Keeps the occupancy grid up to date in small portions: new keyframes first; after a correction it is made anew while the old
// one goes on. It owns no thread, and one that is late shows an older grid and loses nothing.

#include <cstdint>

#include "estimator/grid/occupancy_builder.hpp"
#include "estimator/grid/planar_mapper.hpp"

namespace slamd {

class GridMaker {
 public:
  explicit GridMaker(const OccupancyConfig& config) : shown_{OccupancyBuilder{config}}, next_{OccupancyBuilder{config}} {}

  /// Keyframes have moved: all is to be made anew.
  void corrected() { is_outdated_ = true; }
  /// The map begins anew.
  void clear();
  /// One portion of what is to be done; entered: keyframes that the mapper has got so far, also those it has forgotten. False:
  /// there was nothing.
  bool work(const PlanarMapper& mapper, std::uint64_t entered);

  /// Whether a snapshot would be another one than the last.
  bool has_changed() const { return has_changed_; }
  OccupancyGrid snapshot();
  std::uint64_t shown_keyframes() const { return shown_.done; }

 private:
  struct Grid {
    OccupancyBuilder cells;
    std::uint64_t done = 0;  // keyframes in it
  };
  static void add_portion(const PlanarMapper& mapper, std::uint64_t entered, Grid& grid);

  Grid shown_, next_;
  bool is_making_ = false;  // next_ is being made
  bool is_outdated_ = false;
  bool has_changed_ = false;
};

}  // namespace slamd
