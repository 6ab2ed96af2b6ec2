#pragma once
// Point clouds and texts as files: PCD and PLY through PCL (which is in no header of ours), written into an open file
// descriptor, and files that appear whole or not at all. No reading.

#include <string>
#include <string_view>

#include "daemon/ring/unique_fd.hpp"
#include "estimator/types/point_cloud.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

enum class CloudFormat { kPcd, kPly };

/// A sealed memfd (nobody can change it any more) with the cloud as binary_compressed PCD or binary PLY, fields
/// x y z intensity (metres, 0..255). Any thread; seconds for millions of points.
Result<UniqueFd> cloud_memfd(const PointCloud& points, CloudFormat format);

/// A sealed memfd with the text in it.
Result<UniqueFd> text_memfd(std::string_view text);

/// Writes all of `content` (a file, from its first byte) to `path` by way of a temporary file beside it, synced and
/// then renamed: on any error (disk full, no permission) `path` is as it was. Mode 0640.
Result<void> save_atomically(int content, const std::string& path);

}  // namespace slamd
