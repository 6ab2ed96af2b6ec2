#pragma once
// Writes a cloud to an open file with PCL: the one door to it, because PCL costs 26 s and 1 GB in each translation unit
// that includes it. Private to this folder; callers use cloud_file.hpp.

#include "daemon/store/cloud_file.hpp"

namespace slamd {

/// Writes x y z intensity into `fd` (a fresh, writable memfd). Never throws.
Result<void> write_with_pcl(int fd, const PointCloud& points, CloudFormat format);

}  // namespace slamd
