#pragma once
// Reads the points of a PCD file (ascii, binary, binary_compressed) for pictures. Does not write; that is daemon/store.

#include <string>

#include "estimator/types/point_cloud.hpp"

namespace slamd::plot {

/// Points with finite x, y, z; intensity 0 where the file has none. Any numeric field type is taken.
/// Throws PlotError with the path when the file cannot be read, has no x y z, or holds no point.
PointCloud read_pcd(const std::string& path);

}  // namespace slamd::plot
