#pragma once
// From numbers to pixels: ranges, round tick values and the frame of a chart. Draws grid and labels, no curves.

#include <string>
#include <vector>

#include "tools/plot/canvas.hpp"

namespace slamd::plot {

struct Range {
  double low = 0.0;
  double high = 1.0;

  double span() const { return high - low; }
  void include(double value);  // non-finite values are ignored
};

/// Low above high: include() any value to make it a range.
Range empty_range();
/// Widened by `share` of its span on both sides, and to a span above zero.
Range padded(Range range, double share);

struct Ticks {
  std::vector<double> values;
  double step = 1.0;
};

/// At most about `count` round values (1, 2, 5 times a power of ten) inside the range.
Ticks round_ticks(const Range& range, int count);
/// With just the decimals that the step needs.
std::string tick_label(double value, double step);

struct Theme {
  Colour background;
  Colour ink;    // titles and labels
  Colour faint;  // axes and secondary text
  Colour grid;
};
const Theme& light_theme();
const Theme& dark_theme();

/// The rectangle of a chart on the canvas and the numbers at its edges; y grows upwards.
struct Frame {
  Rect area;
  Range x;
  Range y;

  Point at(double x_value, double y_value) const {
    return {area.x + (x_value - x.low) / x.span() * area.width,
            area.bottom() - (y_value - y.low) / y.span() * area.height};
  }
  double px_per_unit() const { return area.width / x.span(); }
};

/// A frame with the same scale on both axes, both ranges centred in the area.
Frame equal_frame(const Rect& area, Range x, Range y);

struct AxisLabels {
  std::string title;
  std::string x;
  std::string y;
};

/// Grid, tick labels, axis titles and the chart's title, around and inside of frame.area.
void draw_axes(Canvas& canvas, const Frame& frame, const AxisLabels& labels, const Theme& theme);
/// The part of `outer` that remains for the frame when draw_axes writes around it.
Rect inside_axes(const Rect& outer);

}  // namespace slamd::plot
