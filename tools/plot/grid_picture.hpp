#pragma once
// The picture of an occupancy grid with the driven trajectory on it. Reads no file.

#include <string>

#include "tools/plot/grid_file.hpp"
#include "tools/plot/trajectory_plot.hpp"

namespace slamd::plot {

struct GridPicture {
  GridImage grid;
  ColouredPath path;        // metres, in the grid's frame; may be empty
  std::string title;
  std::string subtitle;
  std::string value_label;  // of the path's colour bar
  int width_px = 1200;
};

/// Writes a PNG, width_px wide and as high as what is known of the grid asks for (between 0.45 and 1.1 of the width).
/// Throws PlotError when the file cannot be written.
void write_grid_picture(const GridPicture& picture, const std::string& path);

}  // namespace slamd::plot
