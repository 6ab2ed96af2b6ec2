#pragma once
// The slow methods as jobs: a map made into a memory file or saved to disk, and the whole path as TUM text. They read
// the stores only and run on any thread.

#include <string>

#include "daemon/server/methods.hpp"
#include "daemon/server/params.hpp"
#include "daemon/store/cloud_file.hpp"

namespace slamd {

struct MapRequest {
  MapQuery query;
  CloudFormat format = CloudFormat::kPcd;
};

/// voxel_size_m and box; the format is the caller's.
MapRequest read_map_request(Params& params);

/// Name of a file in the configured folder: a plain one that ends in .pcd or .ply.
bool is_good_map_name(const std::string& name);

Outcome make_map(const MapStore& store, const MapRequest& request, const JobProgress& progress);
Outcome save_map(const MapStore& store, const MapRequest& request, const std::string& path,
                 const JobProgress& progress);
Outcome make_tum(const TrajectoryStore& store);

}  // namespace slamd
