#pragma once
// Point clouds and texts as files: PCD and PLY written piece by piece into a memfd, and files that appear whole or not at
// all. No reading.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "daemon/ring/unique_fd.hpp"
#include "daemon/store/geo_reference.hpp"
#include "estimator/types/point_cloud.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

enum class CloudFormat { kPcd, kPly };

/// Told the share done, 0..1; returning false ends the work: nothing comes back, or the old file stays.
using WriteProgress = std::function<bool(double)>;

struct CloudFileOptions {
  CloudFormat format = CloudFormat::kPcd;
  std::optional<GeoReference> reference;  // becomes comment lines of the header
  WriteProgress progress;                 // empty: not wanted
};

/// Where the points of a file come from: a snapshot of the map, or a cloud in memory.
struct CloudSource {
  std::size_t size = 0;
  /// Fills out with the points from number `begin` on; asked for the same ones several times.
  std::function<void(std::size_t begin, std::span<CloudPoint> out)> read;
};

/// Of a cloud that outlives it.
CloudSource source_of(const PointCloud& points);

/// A sealed memfd (nobody can change it any more) with the cloud as binary_compressed PCD or binary PLY, fields
/// x y z intensity (metres, 0..255). At most 2^28 points. Any thread; asks progress every 65,536 points.
Result<UniqueFd> cloud_memfd(const CloudSource& source, const CloudFileOptions& options = {});

/// The geo-reference as YAML, for a file beside the map: origin_lat_deg, origin_lon_deg, origin_ellipsoid_height_m,
/// T_enu_map with translation_m and rotation_quat_xyzw.
std::string to_yaml(const GeoReference& reference);

/// A sealed memfd with the text in it.
Result<UniqueFd> text_memfd(std::string_view text);

/// Writes all of `content` (a file, from its first byte) to `path` by way of a temporary file beside it, synced and
/// then renamed: on any error (disk full, no permission, told to stop) `path` is as it was. Mode 0640.
Result<void> save_atomically(int content, const std::string& path, const WriteProgress& progress = {});

}  // namespace slamd
