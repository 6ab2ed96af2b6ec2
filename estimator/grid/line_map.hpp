#pragma once
// Where the walls of a level plane run: moments of the points in each cell, by the side from which they were seen, and the
// line through the cells around a place.
// It knows no occupied or free space; that is occupancy_builder.

#include <Eigen/Core>
#include <array>
#include <vector>

#include "estimator/graph/group_se2.hpp"
#include "estimator/grid/planar_scan.hpp"
#include "estimator/grid/tile_grid.hpp"

namespace slamd {

struct LineMapConfig {
  double cell_m = 0.1;          // moments are kept so fine,
  double coarser = 4.0;         // and in cells so many times larger, for walls that are far away
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
  explicit LineMap(const LineMapConfig& config);

  /// Points without a normal are left out.
  void add(const PlanarScan& scan, const PlanarPose& T_map_base);
  /// The line through what the 3 x 3, else the 5 x 5 cells around `p_map`, else those of the coarser layer hold of walls that face
  /// as `normal_map` does (within 22 degrees at least, 67 at most). False: there is none; `line` is then undefined. No allocation.
  bool line_at(const Eigen::Vector2d& p_map, const Eigen::Vector2d& normal_map, WallLine& line) const;

  bool is_empty() const;
  void clear();

 private:
  static constexpr int kSectors = 8;  // of directions: the two sides of a wall and the two walls of a corner do not mix

  struct Cell {
    float count = 0.0F;
    float x = 0.0F, y = 0.0F;                  // sums, from the cell's centre
    float xx = 0.0F, xy = 0.0F, yy = 0.0F;
  };
  struct Moments;
  void gather(const TileGrid<Cell>& cells, const Eigen::Vector2i& middle, int reach, Moments& sum) const;
  static void add(TileGrid<Cell>& cells, const Eigen::Vector2d& p);
  bool fit(const Moments& moments, const Eigen::Vector2d& centre, WallLine& line) const;

  LineMapConfig config_;
  using Sectors = std::vector<TileGrid<Cell>>;  // by the direction of the normal
  std::array<Sectors, 2> layers_;               // fine, then coarse: where points are sparse
};

}  // namespace slamd
