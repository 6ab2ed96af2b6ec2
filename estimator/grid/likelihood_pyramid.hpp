#pragma once
// How likely a point is seen in each cell of a plane, and for blocks of cells the largest of it: what a correlative search
// looks up. No poses here.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "estimator/graph/group_se2.hpp"
#include "estimator/grid/tile_grid.hpp"

namespace slamd {

struct LikelihoodConfig {
  double cell_m = 0.05;
  double sigma_m = 0.07;  // how blurred a point is
  int levels = 4;         // blocks of 1, 2, 4 .. 2^(levels - 1) cells
};

class LikelihoodPyramid {
 public:
  explicit LikelihoodPyramid(const LikelihoodConfig& config);

  /// points  base frame, metres
  void add(std::span<const Eigen::Vector2f> points, const PlanarPose& T_map_base);
  void clear();

  int levels() const { return static_cast<int>(levels_.size()); }
  double cell_m() const { return levels_.front().cell_m(); }
  /// At least the likelihood (0..255) of each of the 2^level x 2^level cells of level 0 that begin at `cell`; on level 0
  /// exactly that of the cell.
  std::uint8_t bound(int level, const Eigen::Vector2i& cell) const {
    return levels_[static_cast<std::size_t>(level)].value(cell.x() >> level, cell.y() >> level);
  }
  std::size_t tiles() const { return levels_.front().tiles(); }

 private:
  void raise(int x, int y, std::uint8_t value);

  struct Stamp {
    int dx, dy;
    std::uint8_t value;
  };
  std::vector<TileGrid<std::uint8_t>> levels_;  // a cell of level h holds the largest of 2^(h+1) x 2^(h+1) cells from its lowest on
  std::vector<Stamp> stamps_;                   // a point's blur
};

}  // namespace slamd
