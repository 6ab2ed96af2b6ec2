#include "daemon/server/grid_job.hpp"

#include "daemon/server/protocol/protocol.hpp"
#include "daemon/store/cloud_file.hpp"
#include "daemon/store/grid_file.hpp"

namespace slamd {

using nlohmann::json;
namespace error = protocol::error;

json grid_json(const GridStore::Newest& newest) {
  const OccupancyGrid& grid = *newest.grid;
  return {{"time_ns", to_ns(newest.time)}, {"changes", newest.changes},
          {"resolution_m", grid.resolution_m}, {"origin_m", {grid.origin.x(), grid.origin.y()}},
          {"width", grid.width}, {"height", grid.height}};
}

Outcome make_grid(const GridStore& store, const GridRequest& request) {
  const GridStore::Newest newest = store.newest();
  if (newest.grid == nullptr) return RpcError{error::kNotYet, "no grid yet"};
  const OccupancyGrid& grid = *newest.grid;
  const std::string bytes = request.as_picture ? grid_picture(grid)
                                               : std::string(reinterpret_cast<const char*>(grid.cells.data()), grid.cells.size());
  Result<UniqueFd> fd = text_memfd(bytes);
  if (!fd) return RpcError{error::kWriteFailed, fd.reason()};
  json result = grid_json(newest);
  result["format"] = request.as_picture ? "pgm" : "cells";
  result["bytes"] = bytes.size();
  result[protocol::kFdField] = true;
  if (request.as_picture) result["yaml"] = grid_yaml(grid, request.name);
  return Reply{std::move(result), std::move(fd).value()};
}

}  // namespace slamd
