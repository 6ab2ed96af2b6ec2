#pragma once
// The ground: a grid of heights, two triangles a cell, with exact ray casting. Materials per cell. Not a solid.

#include <functional>
#include <vector>

#include "tools/slam-sim/world/ray.hpp"

namespace slamd::sim {

class HeightField {
 public:
  using HeightAt = std::function<double(double x, double y)>;

  /// Samples `height` on nodes every cell_m metres over the box low..high.
  HeightField(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double cell_m, const HeightAt& height);

  /// Height of the triangles at (x, y), metres; outside the grid that of the nearest border point.
  double height(double x, double y) const;
  /// Paints the cells whose centres satisfy `inside`.
  void paint(Material material, const std::function<bool(double x, double y)>& inside);
  /// Shortens `hit` to the ground along the ray when that is nearer. Thread-safe.
  void cast(const Ray& ray, Hit& hit) const;

 private:
  struct Cell {
    int ix, iy;
  };
  double node(int ix, int iy) const { return heights_[static_cast<std::size_t>(iy * (nx_ + 1) + ix)]; }
  bool cast_cell(const Ray& ray, Cell cell, double enter, double leave, Hit& hit) const;
  bool cast_block(const Ray& ray, Cell block, double enter, double leave, Hit& hit) const;
  void find_block_tops();

  Eigen::Vector2d low_;
  double cell_m_;
  int nx_, ny_;              // cells
  int block_nx_, block_ny_;  // blocks of kBlock x kBlock cells
  std::vector<double> heights_;
  std::vector<double> block_top_;
  std::vector<Material> materials_;
};

}  // namespace slamd::sim
