#include "estimator/grid/likelihood_pyramid.hpp"

#include <cmath>

namespace slamd {

LikelihoodPyramid::LikelihoodPyramid(const LikelihoodConfig& config) {
  for (int level = 0; level < config.levels; ++level) levels_.emplace_back(config.cell_m * (1 << level));
  const int reach = static_cast<int>(std::ceil(2.0 * config.sigma_m / config.cell_m));
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const double distance = std::hypot(dx, dy) * config.cell_m / config.sigma_m;
      if (distance <= 2.0) stamps_.push_back({dx, dy, static_cast<std::uint8_t>(std::lround(255.0 * std::exp(-0.5 * distance * distance)))});
    }
  }
}

void LikelihoodPyramid::add(std::span<const Eigen::Vector2f> points, const PlanarPose& T_map_base) {
  const Eigen::Matrix2d R = T_map_base.rotation();
  for (const Eigen::Vector2f& point : points) {
    const Eigen::Vector2i cell = levels_.front().cell_of(R * point.cast<double>() + T_map_base.translation);
    if (levels_.front().value(cell.x(), cell.y()) == 255) continue;  // its blur is there already
    for (const Stamp& stamp : stamps_) raise(cell.x() + stamp.dx, cell.y() + stamp.dy, stamp.value);
  }
}

void LikelihoodPyramid::raise(int x, int y, std::uint8_t value) {
  std::uint8_t& fine = levels_.front().at(x, y);
  if (fine >= value) return;
  fine = value;
  for (int level = 1; level < levels(); ++level) {
    TileGrid<std::uint8_t>& blocks = levels_[static_cast<std::size_t>(level)];
    for (const int by : {(y >> level) - 1, y >> level}) {
      for (const int bx : {(x >> level) - 1, x >> level}) {
        std::uint8_t& block = blocks.at(bx, by);
        block = std::max(block, value);
      }
    }
  }
}

void LikelihoodPyramid::clear() {
  for (TileGrid<std::uint8_t>& level : levels_) level.clear();
}

}  // namespace slamd
