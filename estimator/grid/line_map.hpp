#pragma once
// Where the walls of a level plane run: moments of the points in each cell, and the line through the cells around a place.
// It knows no occupied or free space; that is occupancy_builder.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "estimator/graph/group_se2.hpp"
#include "estimator/grid/tile_grid.hpp"

namespace slamd {

struct LineMapConfig {
  double cell_m = 0.1;          // moments are kept so fine
  double least_points = 4.0;    // of a line, at least
  double most_thickness = 0.35;  // standard deviation across over along, at most: else it is no line
  double point_sigma_m = 0.015;  // noise of a point, at least
};

/// A line near a place, in the map's frame.
struct WallLine {
  Eigen::Vector2d mean;
  Eigen::Vector2d normal;       // unit
  double variance_m2 = 0.0;     // of points across the line
  double normal_variance = 0.0;  // of the normal's direction, rad^2
};

class LineMap {
 public:
  explicit LineMap(const LineMapConfig& config) : config_{config}, cells_{config.cell_m} {}

  /// points  of a scan, base frame, metres
  void add(std::span<const Eigen::Vector2f> points, const PlanarPose& T_map_base);
  /// The line through what the 3 x 3, else the 5 x 5 cells around `p_map` hold. False: there is none; `line` is then
  /// undefined. No allocation.
  bool line_at(const Eigen::Vector2d& p_map, WallLine& line) const;

  bool is_empty() const { return cells_.is_empty(); }
  void clear() { cells_.clear(); }
  std::size_t tiles() const { return cells_.tiles(); }

 private:
  struct Cell {
    float count = 0.0F;
    float x = 0.0F, y = 0.0F;                  // sums, from the cell's centre
    float xx = 0.0F, xy = 0.0F, yy = 0.0F;
  };
  struct Moments;
  Moments gather(const Eigen::Vector2i& cell, int reach) const;
  bool fit(const Moments& moments, const Eigen::Vector2d& centre, WallLine& line) const;

  LineMapConfig config_;
  TileGrid<Cell> cells_;
};

}  // namespace slamd
