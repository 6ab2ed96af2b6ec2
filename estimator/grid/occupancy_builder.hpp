#pragma once
// Which squares of the map are free and which are not: log-odds of rays that went through and rays that ended. It does not
// match scans.

#include "estimator/grid/planar_scan.hpp"
#include "estimator/grid/tile_grid.hpp"
#include "estimator/graph/group_se2.hpp"
#include "estimator/types/occupancy_grid.hpp"

namespace slamd {

struct OccupancyConfig {
  double resolution_m = 0.05;
  double hit_probability = 0.65;    // of a cell in which a ray ended to be occupied
  double miss_probability = 0.4;   // likewise through which one went
  double occupied_above = 0.65;     // probabilities of the three values of a snapshot
  double free_below = 0.25;
};

class OccupancyBuilder {
 public:
  explicit OccupancyBuilder(const OccupancyConfig& config);

  /// Rays from the LiDAR to each point; a cell counts once a scan, as hit when any ray ended in it.
  void add(const PlanarScan& scan, const PlanarPose& T_map_base);
  void clear() { cells_.clear(); }

  /// Log-odds of a cell, 0 where nothing is known.
  double log_odds(const Eigen::Vector2d& p_map) const;
  /// Smallest rectangle that holds all that is known.
  OccupancyGrid snapshot() const;

 private:
  struct Cell {
    float log_odds = 0.0F;
    std::uint32_t scan = 0;  // that changed it last
    bool seen = false;
  };
  void change(int x, int y, float by);
  void trace(const Eigen::Vector2i& from, const Eigen::Vector2i& to);

  OccupancyConfig config_;
  float hit_, miss_;
  std::uint32_t scan_ = 0;
  TileGrid<Cell> cells_;
};

}  // namespace slamd
