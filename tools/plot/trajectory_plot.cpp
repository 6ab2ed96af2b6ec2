#include "tools/plot/trajectory_plot.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::plot {
namespace {

constexpr double kBarColumnPx = 92.0;

std::vector<Point> to_pixels(const Frame& frame, const std::vector<Point>& points) {
  std::vector<Point> pixels;
  pixels.reserve(points.size());
  for (const Point& p : points) pixels.push_back(frame.at(p.x, p.y));
  return pixels;
}

Frame frame_around(const Rect& area, const TrajectoryPlot& plot) {
  Range x = empty_range();
  Range y = empty_range();
  for (const auto* points : {&plot.path.points, &plot.reference}) {
    for (const Point& p : *points) {
      x.include(p.x);
      y.include(p.y);
    }
  }
  return equal_frame(area, padded(x, 0.06), padded(y, 0.06));
}

}  // namespace

Range colour_range(std::vector<double> values) {
  if (values.empty()) return {0.0, 1.0};
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return {0.0, *place > 0.0 ? *place : 1.0};
}

void draw_coloured_path(Canvas& canvas, const Frame& frame, const ColouredPath& path, double width_px,
                        const Colour& casing) {
  const std::vector<Point> pixels = to_pixels(frame, path.points);
  canvas.polyline(pixels, {casing, width_px + 3.0});
  for (std::size_t i = 1; i < pixels.size(); ++i) {
    const double share = (path.values[i] - path.range.low) / path.range.span();
    canvas.line(pixels[i - 1], pixels[i], {error_gradient().at(share), width_px});
  }
}

void draw_colour_bar(Canvas& canvas, const Rect& bar, const ColourScale& scale, const Theme& theme) {
  const int rows = std::max(2, static_cast<int>(bar.height));
  for (int row = 0; row < rows; ++row) {
    const double share = 1.0 - static_cast<double>(row) / (rows - 1);
    const Colour colour = scale.gradient.at(scale.square_root ? std::sqrt(share) : share);
    canvas.fill({bar.x, bar.y + row, bar.width, 1.5}, colour);
  }
  const Ticks ticks = round_ticks(scale.range, static_cast<int>(bar.height / 38.0));
  for (const double value : ticks.values) {
    const double y = bar.bottom() - (value - scale.range.low) / scale.range.span() * bar.height;
    canvas.line({bar.right(), y}, {bar.right() + 4.0, y}, {theme.faint, 1.0});
    canvas.text({bar.right() + 8.0, y}, tick_label(value, ticks.step), {12.0, theme.faint, Align::kBegin, Align::kMiddle});
  }
  canvas.text({bar.x, bar.y - 10.0}, scale.label, {13.0, theme.ink});
}

void draw_trajectory_plot(Canvas& canvas, const Rect& outer, const TrajectoryPlot& plot, const Theme& theme) {
  Rect area = inside_axes(outer);
  area.width -= kBarColumnPx;
  const Frame frame = frame_around(area, plot);
  draw_axes(canvas, frame, plot.labels, theme);
  canvas.clipped(area, [&] {
    const std::vector<Point> reference = to_pixels(frame, plot.reference);
    canvas.polyline(reference, {theme.faint, 1.5, {5.0, 5.0}});
    draw_coloured_path(canvas, frame, plot.path, 4.0, theme.background);
  });
  if (!plot.path.points.empty()) {
    const Point start = frame.at(plot.path.points.front().x, plot.path.points.front().y);
    canvas.disc(start, 7.0, theme.background);
    canvas.disc(start, 5.0, theme.ink);
  }
  draw_colour_bar(canvas, {area.right() + 26.0, area.y + 24.0, 16.0, area.height - 24.0}, 
                  {plot.path.range, plot.value_label, error_gradient()}, theme);
}

}  // namespace slamd::plot
