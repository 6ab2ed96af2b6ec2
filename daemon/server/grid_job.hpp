#pragma once
// get_grid as a job: the newest occupancy grid into a memory file, as cells or as a picture. It reads the store alone and runs
// on any thread.

#include <string>

#include "daemon/server/methods.hpp"
#include "daemon/store/grid_store.hpp"

namespace slamd {

struct GridRequest {
  bool as_picture = false;  // PGM and the YAML of map_server; else the cells themselves
  std::string name;         // of the picture's file, for the YAML
};

/// What is told of a grid beside its cells, in get_grid and in the notification. newest.grid is not null.
nlohmann::json grid_json(const GridStore::Newest& newest);

Outcome make_grid(const GridStore& store, const GridRequest& request);

}  // namespace slamd
