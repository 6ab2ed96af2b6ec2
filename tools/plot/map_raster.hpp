#pragma once
// A point cloud as an image seen from above: one colour a pixel. Draws no overlay; that is map_picture.

#include <cstdint>
#include <vector>

#include "estimator/types/point_cloud.hpp"
#include "tools/plot/axis.hpp"

namespace slamd::plot {

enum class MapColour { kHeight, kIntensity };

/// What each point is coloured by: metres above the ground around it (the low points within 6 m), or its intensity.
std::vector<float> map_values(const PointCloud& points, MapColour colour);

/// From 0 to the 98th percentile.
Range map_value_range(std::vector<float> values);

struct RasterStyle {
  Range range;
  double point_radius_m = 0.15;  // a point is a soft spot of this size, at least one pixel
};

/// Premultiplied 0xAARRGGBB, row-major, one pixel a canvas pixel of frame.area. The highest value wins a pixel, the number
/// of points gives its brightness; no point, no colour.
std::vector<std::uint32_t> rasterise(const PointCloud& points, const std::vector<float>& values, const Frame& frame,
                                     const RasterStyle& style);

}  // namespace slamd::plot
