#include "estimator/grid/line_map.hpp"

#include <algorithm>
#include <cmath>

namespace slamd {

struct LineMap::Moments {
  double count = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;  // from the middle cell's centre
};

namespace {

/// In sectors: the lower of the two whose middles are around the direction; the other one is the next.
double sector_of(const Eigen::Vector2d& normal, int sectors) {
  return (std::atan2(normal.y(), normal.x()) / (2.0 * M_PI) + 1.0) * sectors;
}

}  // namespace

LineMap::LineMap(const LineMapConfig& config)
    : config_{config},
      layers_{Sectors(kSectors, TileGrid<Cell>{config.cell_m}), Sectors(kSectors, TileGrid<Cell>{config.coarser * config.cell_m})} {}

void LineMap::add(TileGrid<Cell>& cells, const Eigen::Vector2d& p) {
  const Eigen::Vector2i index = cells.cell_of(p);
  const Eigen::Vector2f d = (p - cells.centre(index.x(), index.y())).cast<float>();
  Cell& cell = cells.at(index.x(), index.y());
  cell.count += 1.0F;
  cell.x += d.x();
  cell.y += d.y();
  cell.xx += d.x() * d.x();
  cell.xy += d.x() * d.y();
  cell.yy += d.y() * d.y();
}

void LineMap::add(const PlanarScan& scan, const PlanarPose& T_map_base) {
  const Eigen::Matrix2d R = T_map_base.rotation();
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.normals[i].isZero()) continue;
    const Eigen::Vector2d normal = R * scan.normals[i].cast<double>();
    const Eigen::Vector2d p = R * scan.points[i].cast<double>() + T_map_base.translation;
    const auto sector = static_cast<std::size_t>(std::lround(sector_of(normal, kSectors))) % kSectors;
    for (Sectors& layer : layers_) add(layer[sector], p);
  }
}

void LineMap::gather(const TileGrid<Cell>& cells, const Eigen::Vector2i& middle, int reach, Moments& sum) const {
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const Cell* cell = cells.find(middle.x() + dx, middle.y() + dy);
      if (cell == nullptr || cell->count == 0.0F) continue;
      const double ox = dx * cells.cell_m();
      const double oy = dy * cells.cell_m();
      const double n = cell->count;
      sum.count += n;
      sum.x += cell->x + n * ox;
      sum.y += cell->y + n * oy;
      sum.xx += cell->xx + 2.0 * ox * cell->x + n * ox * ox;
      sum.xy += cell->xy + ox * cell->y + oy * cell->x + n * ox * oy;
      sum.yy += cell->yy + 2.0 * oy * cell->y + n * oy * oy;
    }
  }
}

bool LineMap::fit(const Moments& m, const Eigen::Vector2d& centre, WallLine& line) const {
  if (m.count < config_.least_points) return false;
  const double mx = m.x / m.count;
  const double my = m.y / m.count;
  const double cxx = m.xx / m.count - mx * mx;
  const double cxy = m.xy / m.count - mx * my;
  const double cyy = m.yy / m.count - my * my;
  const double half = 0.5 * (cxx - cyy);
  const double root = std::hypot(half, cxy);
  const double along = 0.5 * (cxx + cyy) + root;
  const double across = std::max(0.0, 0.5 * (cxx + cyy) - root);
  // Few points lie on a line by chance: what a point's own noise would put there counts as two of them.
  const double noise = config_.point_sigma_m * config_.point_sigma_m;
  const double variance = (across * m.count + 2.0 * noise) / m.count;
  if (along < noise || variance > config_.most_thickness * config_.most_thickness * along) return false;
  const double angle = 0.5 * std::atan2(cxy, half);  // of the line's direction
  line.mean = centre + Eigen::Vector2d{mx, my};
  line.normal = {-std::sin(angle), std::cos(angle)};
  line.variance_m2 = variance + noise;
  line.normal_variance = (variance + noise) / (m.count * along);
  return true;
}

bool LineMap::line_at(const Eigen::Vector2d& p_map, const Eigen::Vector2d& normal_map, WallLine& line) const {
  const auto lower = static_cast<std::size_t>(sector_of(normal_map, kSectors));
  const auto try_cells = [&](const Sectors& layer, int reach) {
    const Eigen::Vector2i middle = layer.front().cell_of(p_map);
    Moments sum;
    gather(layer[lower % kSectors], middle, reach, sum);
    gather(layer[(lower + 1) % kSectors], middle, reach, sum);
    return fit(sum, layer.front().centre(middle.x(), middle.y()), line);
  };
  return try_cells(layers_[0], 1) || try_cells(layers_[0], 2) || try_cells(layers_[1], 1);
}

bool LineMap::is_empty() const {
  return std::ranges::all_of(layers_[0], [](const TileGrid<Cell>& cells) { return cells.is_empty(); });
}

void LineMap::clear() {
  for (Sectors& layer : layers_) {
    for (TileGrid<Cell>& cells : layer) cells.clear();
  }
}

}  // namespace slamd
