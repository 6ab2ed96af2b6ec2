#pragma once
// The newest occupancy grid, handed from the thread that makes it to whoever reads it. It keeps one grid and makes none.

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include "estimator/types/occupancy_grid.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

class GridStore {
 public:
  struct Newest {
    std::shared_ptr<const OccupancyGrid> grid;  // null: none so far
    HostTime time;                              // when it was made
    std::uint64_t changes = 0;                  // grids so far
  };

  /// Any thread, as all of this class. Those who still hold the one before keep it.
  void put(OccupancyGrid grid, HostTime time) {
    auto made = std::make_shared<const OccupancyGrid>(std::move(grid));
    const std::lock_guard lock{mutex_};
    std::swap(newest_.grid, made);
    newest_.time = time;
    ++newest_.changes;
  }
  Newest newest() const {
    const std::lock_guard lock{mutex_};
    return newest_;
  }

 private:
  mutable std::mutex mutex_;
  Newest newest_;
};

}  // namespace slamd
