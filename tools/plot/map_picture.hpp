#pragma once
// The picture of a map from above with the driven trajectory on it. Reads no file: points and paths come in.

#include <string>
#include <vector>

#include "tools/plot/map_raster.hpp"
#include "tools/plot/trajectory_plot.hpp"

namespace slamd::plot {

struct MapPicture {
  PointCloud points;                      // metres, in the frame of the paths
  MapColour colour = MapColour::kHeight;
  ColouredPath path;                      // without values: drawn in one colour
  std::vector<Point> truth;               // thin and dashed; may be empty
  std::string title;
  std::string subtitle;
  std::string value_label;                // of the path's colour bar
  int width_px = 1800;
};

/// Writes a PNG, width_px wide and as high as the map asks for (between 0.45 and 1.1 of the width).
/// Throws PlotError when the file cannot be written.
void write_map_picture(const MapPicture& picture, const std::string& path);

}  // namespace slamd::plot
