#include "tools/plot/grid_picture.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::plot {
namespace {

constexpr double kHeaderPx = 84.0;
constexpr double kBarPx = 120.0;
constexpr std::uint8_t kUnknownGrey = 205;

struct Extent {
  Range x = empty_range();
  Range y = empty_range();
};

double x_of(const GridImage& grid, std::size_t column) { return grid.x_m + static_cast<double>(column) * grid.resolution_m; }
double y_of(const GridImage& grid, std::size_t row) { return grid.y_m + static_cast<double>(grid.rows - row) * grid.resolution_m; }

/// Of all that is known, and of the path.
Extent extent_of(const GridPicture& picture) {
  Extent extent;
  const GridImage& grid = picture.grid;
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns; ++column) {
      if (grid.grey[row * grid.columns + column] == kUnknownGrey) continue;
      extent.x.include(x_of(grid, column));
      extent.y.include(y_of(grid, row));
    }
  }
  for (const Point& p : picture.path.points) {
    extent.x.include(p.x);
    extent.y.include(p.y);
  }
  if (extent.x.low > extent.x.high) extent = {{0.0, 1.0}, {0.0, 1.0}};
  return {padded(extent.x, 0.03), padded(extent.y, 0.03)};
}

/// The darkest cell under a pixel, so that a wall of one cell is seen at any scale; of the cells known, if any is.
std::uint8_t grey_under(const GridImage& grid, const Range& x, const Range& y) {
  const auto index = [](double value, std::size_t end) {
    return static_cast<std::size_t>(std::clamp(value, 0.0, static_cast<double>(end)));
  };
  const double height_m = static_cast<double>(grid.rows) * grid.resolution_m;
  const std::size_t left = index((x.low - grid.x_m) / grid.resolution_m, grid.columns);
  const std::size_t right = index((x.high - grid.x_m) / grid.resolution_m + 1.0, grid.columns);
  const std::size_t top = index((grid.y_m + height_m - y.high) / grid.resolution_m, grid.rows);
  const std::size_t bottom = index((grid.y_m + height_m - y.low) / grid.resolution_m + 1.0, grid.rows);
  std::uint8_t darkest = 255;
  for (std::size_t row = top; row < bottom; ++row) {
    for (std::size_t column = left; column < right; ++column) {
      const std::uint8_t grey = grid.grey[row * grid.columns + column];
      if (grey != kUnknownGrey) darkest = std::min(darkest, grey);
    }
  }
  return darkest == 255 ? kUnknownGrey : darkest;
}

std::vector<std::uint32_t> pixels_of(const GridImage& grid, const Frame& frame) {
  const auto columns = static_cast<std::size_t>(frame.area.width), rows = static_cast<std::size_t>(frame.area.height);
  const double pixel_m = 1.0 / frame.px_per_unit();
  std::vector<std::uint32_t> pixels(columns * rows);
  for (std::size_t row = 0; row < rows; ++row) {
    const double high = frame.y.high - static_cast<double>(row) * pixel_m;
    for (std::size_t column = 0; column < columns; ++column) {
      const double low = frame.x.low + static_cast<double>(column) * pixel_m;
      const std::uint32_t grey = grey_under(grid, {low, low + pixel_m}, {high - pixel_m, high});
      pixels[row * columns + column] = 0xFF000000U | grey << 16U | grey << 8U | grey;
    }
  }
  return pixels;
}

void draw_path(Canvas& canvas, const Frame& frame, const ColouredPath& path) {
  if (!path.values.empty()) return draw_coloured_path(canvas, frame, path, 3.0, rgb(0xFFFFFF, 0.6));
  std::vector<Point> points;
  for (const Point& p : path.points) points.push_back(frame.at(p.x, p.y));
  canvas.polyline(points, {series_colour(0), 3.0});
}

}  // namespace

void write_grid_picture(const GridPicture& picture, const std::string& path) {
  const Theme& theme = light_theme();
  const Extent extent = extent_of(picture);
  const double map_px = (picture.width_px - kBarPx) * extent.y.span() / extent.x.span();
  const int height_px = static_cast<int>(std::clamp(map_px + kHeaderPx, 0.45 * picture.width_px, 1.1 * picture.width_px));
  Canvas canvas(picture.width_px, height_px, theme.background);
  const Frame frame = equal_frame({0.0, kHeaderPx, picture.width_px - kBarPx, height_px - kHeaderPx}, extent.x, extent.y);
  canvas.image(pixels_of(picture.grid, frame), static_cast<int>(frame.area.width), frame.area);
  if (!picture.path.points.empty()) {
    canvas.clipped(frame.area, [&] { draw_path(canvas, frame, picture.path); });
  }
  if (!picture.path.values.empty()) {
    const Rect bar{frame.area.right() + 26.0, frame.area.y + 34.0, 16.0, std::min(360.0, frame.area.height - 70.0)};
    draw_colour_bar(canvas, bar, {picture.path.range, picture.value_label, error_gradient()}, theme);
  }
  canvas.text({28.0, 40.0}, picture.title, {25.0, theme.ink, Align::kBegin, Align::kEnd, true});
  canvas.text({28.0, 66.0}, picture.subtitle, {15.0, theme.faint});
  canvas.save_png(path);
}

}  // namespace slamd::plot
