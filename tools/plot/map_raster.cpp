#include "tools/plot/map_raster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slamd::plot {
namespace {

constexpr float kGroundCellM = 4.0F;
constexpr double kGroundShare = 0.10;  // of the points of a cell lie below what counts as its ground
constexpr std::size_t kMaxCells = 16'000'000;

// The ground height around every place, from the low points of coarse cells.
class GroundGrid {
 public:
  explicit GroundGrid(const PointCloud& points) {
    Range x = empty_range();
    Range y = empty_range();
    for (const CloudPoint& p : points) {
      x.include(p.x);
      y.include(p.y);
    }
    x_low_ = static_cast<float>(x.low);
    y_low_ = static_cast<float>(y.low);
    const double area_cells = (x.span() / kGroundCellM + 1.0) * (y.span() / kGroundCellM + 1.0);
    const double shrink = std::max(1.0, std::sqrt(area_cells / static_cast<double>(kMaxCells)));
    cell_m_ = kGroundCellM * static_cast<float>(shrink);
    columns_ = static_cast<std::size_t>(x.span() / cell_m_) + 1;
    rows_ = static_cast<std::size_t>(y.span() / cell_m_) + 1;
    measure(points);
  }

  float ground(const CloudPoint& p) const { return smooth_[cell_of(p)]; }

 private:
  std::size_t cell_of(const CloudPoint& p) const {
    const auto column = static_cast<std::size_t>((p.x - x_low_) / cell_m_);
    const auto row = static_cast<std::size_t>((p.y - y_low_) / cell_m_);
    return std::min(row, rows_ - 1) * columns_ + std::min(column, columns_ - 1);
  }

  void measure(const PointCloud& points) {
    std::vector<std::pair<std::size_t, float>> heights;
    heights.reserve(points.size());
    for (const CloudPoint& p : points) heights.emplace_back(cell_of(p), p.z);
    std::sort(heights.begin(), heights.end());
    std::vector<float> low(columns_ * rows_, std::numeric_limits<float>::infinity());
    for (std::size_t begin = 0, end = 0; begin < heights.size(); begin = end) {
      while (end < heights.size() && heights[end].first == heights[begin].first) ++end;
      const auto rank = static_cast<std::size_t>(kGroundShare * static_cast<double>(end - begin - 1));
      low[heights[begin].first] = heights[begin + rank].second;
    }
    smooth_.resize(low.size());
    for (std::size_t cell = 0; cell < low.size(); ++cell) smooth_[cell] = lowest_around(low, cell);
  }

  float lowest_around(const std::vector<float>& low, std::size_t cell) const {
    const std::size_t row = cell / columns_;
    const std::size_t column = cell % columns_;
    float lowest = low[cell];
    for (std::size_t r = row - std::min<std::size_t>(row, 1); r <= std::min(row + 1, rows_ - 1); ++r) {
      for (std::size_t c = column - std::min<std::size_t>(column, 1); c <= std::min(column + 1, columns_ - 1); ++c) {
        lowest = std::min(lowest, low[r * columns_ + c]);
      }
    }
    return lowest;
  }

  float x_low_ = 0.0F;
  float y_low_ = 0.0F;
  float cell_m_ = kGroundCellM;
  std::size_t columns_ = 1;
  std::size_t rows_ = 1;
  std::vector<float> smooth_;
};

struct Layers {
  int columns;
  int rows;
  std::vector<float> weight;
  std::vector<float> top;
};

// Adds one soft spot around pixel (u, v).
void splat(Layers& layers, double u, double v, double radius_px, float value) {
  const int reach = static_cast<int>(std::ceil(2.0 * radius_px));
  const int u0 = static_cast<int>(std::floor(u));
  const int v0 = static_cast<int>(std::floor(v));
  for (int row = std::max(0, v0 - reach); row <= std::min(layers.rows - 1, v0 + reach); ++row) {
    for (int column = std::max(0, u0 - reach); column <= std::min(layers.columns - 1, u0 + reach); ++column) {
      const double du = column + 0.5 - u;
      const double dv = row + 0.5 - v;
      const double share = std::exp(-(du * du + dv * dv) / (radius_px * radius_px));
      if (share < 0.05) continue;
      const auto i = static_cast<std::size_t>(row * layers.columns + column);
      layers.weight[i] += static_cast<float>(share);
      if (share > 0.35) layers.top[i] = std::max(layers.top[i], value);
    }
  }
}

// The weight that a pixel in the midst of the map has.
float typical_weight(const std::vector<float>& weights) {
  std::vector<float> seen;
  for (const float w : weights) {
    if (w > 0.05F) seen.push_back(w);
  }
  if (seen.empty()) return 1.0F;
  const auto middle = seen.begin() + static_cast<std::ptrdiff_t>(seen.size() / 2);
  std::nth_element(seen.begin(), middle, seen.end());
  return std::max(*middle, 0.2F);
}

std::uint32_t premultiplied(const Colour& colour, double alpha) {
  const auto byte = [alpha](double channel) { return static_cast<std::uint32_t>(std::lround(255.0 * alpha * channel)); };
  return (byte(1.0) << 24) | (byte(colour.red) << 16) | (byte(colour.green) << 8) | byte(colour.blue);
}

}  // namespace

std::vector<float> map_values(const PointCloud& points, MapColour colour) {
  std::vector<float> values;
  values.reserve(points.size());
  if (colour == MapColour::kIntensity) {
    for (const CloudPoint& p : points) values.push_back(p.intensity);
    return values;
  }
  const GroundGrid grid(points);
  for (const CloudPoint& p : points) values.push_back(std::max(0.0F, p.z - grid.ground(p)));
  return values;
}

Range map_value_range(std::vector<float> values) {
  if (values.empty()) return {0.0, 1.0};
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return {0.0, *place > 0.0F ? static_cast<double>(*place) : 1.0};
}

std::vector<std::uint32_t> rasterise(const PointCloud& points, const std::vector<float>& values, const Frame& frame,
                                     const RasterStyle& style) {
  Layers layers{static_cast<int>(frame.area.width), static_cast<int>(frame.area.height), {}, {}};
  const auto size = static_cast<std::size_t>(layers.columns) * static_cast<std::size_t>(layers.rows);
  layers.weight.assign(size, 0.0F);
  layers.top.assign(size, -1.0F);
  const double radius_px = std::clamp(style.point_radius_m * frame.px_per_unit(), 0.9, 6.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point pixel = frame.at(points[i].x, points[i].y);
    const double u = pixel.x - frame.area.x;
    const double v = pixel.y - frame.area.y;
    if (u < -8.0 || v < -8.0 || u > layers.columns + 8.0 || v > layers.rows + 8.0) continue;
    splat(layers, u, v, radius_px, values[i]);
  }
  const double typical = typical_weight(layers.weight);
  std::vector<std::uint32_t> pixels(size, 0);
  for (std::size_t i = 0; i < size; ++i) {
    if (layers.weight[i] <= 0.0F) continue;
    const double alpha = 1.0 - std::exp(-1.1 * static_cast<double>(layers.weight[i]) / typical);
    const double share = (static_cast<double>(std::max(0.0F, layers.top[i])) - style.range.low) / style.range.span();
    pixels[i] = premultiplied(height_gradient().at(std::sqrt(std::clamp(share, 0.0, 1.0))), alpha);
  }
  return pixels;
}

}  // namespace slamd::plot
