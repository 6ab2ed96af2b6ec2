#include "estimator/grid/occupancy_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slamd {
namespace {

constexpr float kMost = 4.0F;  // log-odds; so that a door that opens is seen again

float log_odds_of(double probability) { return static_cast<float>(std::log(probability / (1.0 - probability))); }

}  // namespace

OccupancyBuilder::OccupancyBuilder(const OccupancyConfig& config)
    : config_{config},
      hit_{log_odds_of(config.hit_probability)},
      miss_{log_odds_of(config.miss_probability)},
      cells_{config.resolution_m} {}

void OccupancyBuilder::change(int x, int y, float by) {
  Cell& cell = cells_.at(x, y);
  if (cell.scan == scan_) return;
  cell.scan = scan_;
  cell.seen = true;
  cell.log_odds = std::clamp(cell.log_odds + by, -kMost, kMost);
}

void OccupancyBuilder::add(const PlanarScan& scan, const PlanarPose& T_map_base) {
  ++scan_;
  const Eigen::Matrix2d R = T_map_base.rotation();
  const auto cell_of = [&](const Eigen::Vector2f& p) {
    return cells_.cell_of(R * p.cast<double>() + T_map_base.translation);
  };
  // Ends first: a ray that passes close by another's end does not clear it.
  for (const Eigen::Vector2f& point : scan.points) {
    const Eigen::Vector2i cell = cell_of(point);
    change(cell.x(), cell.y(), hit_);
  }
  const Eigen::Vector2i from = cell_of(scan.origin);
  for (const Eigen::Vector2f& point : scan.points) trace(from, cell_of(point));
}

/// Bresenham from the LiDAR to the cell before the end.
void OccupancyBuilder::trace(const Eigen::Vector2i& from, const Eigen::Vector2i& to) {
  const Eigen::Vector2i d = (to - from).cwiseAbs();
  const Eigen::Vector2i sign{to.x() < from.x() ? -1 : 1, to.y() < from.y() ? -1 : 1};
  Eigen::Vector2i at = from;
  int error = d.x() - d.y();
  while (at != to) {
    change(at.x(), at.y(), miss_);
    const int twice = 2 * error;
    if (twice > -d.y()) {
      error -= d.y();
      at.x() += sign.x();
    }
    if (twice < d.x()) {
      error += d.x();
      at.y() += sign.y();
    }
  }
}

double OccupancyBuilder::log_odds(const Eigen::Vector2d& p_map) const {
  const Eigen::Vector2i cell = cells_.cell_of(p_map);
  return cells_.value(cell.x(), cell.y()).log_odds;
}

OccupancyGrid OccupancyBuilder::snapshot() const {
  OccupancyGrid grid;
  grid.resolution_m = config_.resolution_m;
  Eigen::Vector2i low = Eigen::Vector2i::Constant(std::numeric_limits<int>::max());
  Eigen::Vector2i high = Eigen::Vector2i::Constant(std::numeric_limits<int>::min());
  cells_.for_each([&](int x, int y, const Cell& cell) {
    if (!cell.seen) return;
    low = low.cwiseMin(Eigen::Vector2i{x, y});
    high = high.cwiseMax(Eigen::Vector2i{x, y});
  });
  if (low.x() > high.x()) return grid;
  grid.origin = low.cast<double>() * config_.resolution_m;
  grid.width = static_cast<std::uint32_t>(high.x() - low.x() + 1);
  grid.height = static_cast<std::uint32_t>(high.y() - low.y() + 1);
  grid.cells.assign(static_cast<std::size_t>(grid.width) * grid.height, kUnknownCell);
  const float occupied = log_odds_of(config_.occupied_above);
  const float free = log_odds_of(config_.free_below);
  cells_.for_each([&](int x, int y, const Cell& cell) {
    if (!cell.seen) return;
    std::int8_t& value = grid.cells[static_cast<std::size_t>(y - low.y()) * grid.width + static_cast<std::size_t>(x - low.x())];
    if (cell.log_odds > occupied) value = kOccupiedCell;
    if (cell.log_odds < free) value = kFreeCell;
  });
  return grid;
}

}  // namespace slamd
