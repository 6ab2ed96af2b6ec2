#pragma once
// A chart of curves over one axis with legend. Not for maps: see trajectory_plot and map_picture.

#include <string>
#include <vector>

#include "tools/plot/axis.hpp"

namespace slamd::plot {

struct Series {
  std::string label;          // empty = not in the legend
  std::vector<Point> points;  // a non-finite y breaks the curve
  Stroke stroke;
};

struct LineChart {
  AxisLabels labels;
  std::vector<Series> series;
  bool y_from_zero = true;  // errors and latencies read wrong on a cut axis
};

/// A level line over the whole width, e.g. a mean.
Series level(const std::string& label, double y, double x_low, double x_high, const Colour& colour);

/// Draws the chart with its axes into `outer`.
void draw_line_chart(Canvas& canvas, const Rect& outer, const LineChart& chart, const Theme& theme);

}  // namespace slamd::plot
