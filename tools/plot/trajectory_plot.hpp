#pragma once
// Trajectories seen from above, coloured by a value with a colour bar. The point cloud below is map_picture's.

#include <string>
#include <vector>

#include "tools/plot/axis.hpp"

namespace slamd::plot {

struct ColouredPath {
  std::vector<Point> points;   // metres, x right and y up
  std::vector<double> values;  // one a point
  Range range;                 // of the colours
};

struct TrajectoryPlot {
  AxisLabels labels;
  std::vector<Point> reference;  // drawn below, dashed; may be empty
  ColouredPath path;
  std::string value_label;  // beside the colour bar
};

/// From 0 to the 98th percentile of the values, so that one outlier does not swallow all colours.
Range colour_range(std::vector<double> values);

/// Draws the path with a casing so that it stands out from any background.
void draw_coloured_path(Canvas& canvas, const Frame& frame, const ColouredPath& path, double width_px,
                        const Colour& casing);

/// What a colour bar explains.
struct ColourScale {
  Range range;
  std::string label;
  const Gradient& gradient;
  bool square_root = false;  // colours go by the root of the share, so that small values differ more
};

/// An upright bar with ticks to its right; the label stands above it.
void draw_colour_bar(Canvas& canvas, const Rect& bar, const ColourScale& scale, const Theme& theme);

/// Draws axes with equal scales, both paths and the colour bar into `outer`.
void draw_trajectory_plot(Canvas& canvas, const Rect& outer, const TrajectoryPlot& plot, const Theme& theme);

}  // namespace slamd::plot
