#include "tools/plot/line_chart.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::plot {
namespace {

Frame frame_of(const Rect& area, const LineChart& chart) {
  Range x = empty_range();
  Range y = empty_range();
  for (const Series& series : chart.series) {
    for (const Point& p : series.points) {
      x.include(p.x);
      y.include(p.y);
    }
  }
  if (chart.y_from_zero) y.include(0.0);
  Range y_padded = padded(y, 0.06);
  if (chart.y_from_zero && y.low >= 0.0) y_padded.low = 0.0;
  return {area, padded(x, 0.0), y_padded};
}

void draw_curve(Canvas& canvas, const Frame& frame, const Series& series) {
  std::vector<Point> run;
  for (const Point& p : series.points) {
    if (std::isfinite(p.y)) {
      run.push_back(frame.at(p.x, p.y));
    } else {
      canvas.polyline(run, series.stroke);
      run.clear();
    }
  }
  canvas.polyline(run, series.stroke);
}

void draw_legend(Canvas& canvas, const Rect& area, const std::vector<Series>& all, const Theme& theme) {
  constexpr double kRowPx = 21.0;
  const TextStyle style{13.0, theme.ink, Align::kBegin, Align::kMiddle};
  double text_px = 0.0;
  double rows = 0.0;
  for (const Series& series : all) {
    if (series.label.empty()) continue;
    text_px = std::max(text_px, canvas.text_width(series.label, style));
    rows += 1.0;
  }
  if (rows == 0.0) return;
  const Rect box{area.right() - text_px - 66.0, area.y + 10.0, text_px + 56.0, rows * kRowPx + 10.0};
  Colour veil = theme.background;
  veil.alpha = 0.85;
  canvas.fill(box, veil, 5.0);
  double y = box.y + 5.0 + 0.5 * kRowPx;
  for (const Series& series : all) {
    if (series.label.empty()) continue;
    canvas.line({box.x + 10.0, y}, {box.x + 36.0, y}, series.stroke);
    canvas.text({box.x + 44.0, y}, series.label, style);
    y += kRowPx;
  }
}

}  // namespace

Series level(const std::string& label, double y, double x_low, double x_high, const Colour& colour) {
  return {label, {{x_low, y}, {x_high, y}}, {colour, 1.6, {7.0, 5.0}}};
}

void draw_line_chart(Canvas& canvas, const Rect& outer, const LineChart& chart, const Theme& theme) {
  const Frame frame = frame_of(inside_axes(outer), chart);
  draw_axes(canvas, frame, chart.labels, theme);
  canvas.clipped(frame.area, [&] {
    for (const Series& series : chart.series) draw_curve(canvas, frame, series);
  });
  draw_legend(canvas, frame.area, chart.series, theme);
}

}  // namespace slamd::plot
