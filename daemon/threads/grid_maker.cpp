#include "daemon/threads/grid_maker.hpp"

#include <algorithm>
#include <utility>

namespace slamd {
namespace {

constexpr std::uint64_t kPortion = 4;  // keyframes

}  // namespace

void GridMaker::clear() {
  shown_.cells.clear();
  shown_.done = 0;
  is_making_ = is_outdated_ = false;
  has_changed_ = true;
}

bool GridMaker::work(const PlanarMapper& mapper, std::uint64_t entered) {
  if (shown_.done < entered) {
    add_portion(mapper, entered, shown_);
    has_changed_ = true;
    return true;
  }
  if (!is_making_) {
    if (!std::exchange(is_outdated_, false)) return false;
    next_.cells.clear();
    next_.done = 0;
    is_making_ = true;
  }
  add_portion(mapper, entered, next_);
  if (next_.done < entered) return true;
  std::swap(shown_, next_);
  next_.cells.clear();
  is_making_ = false;
  has_changed_ = true;
  return true;
}

/// What the mapper has forgotten is passed over.
void GridMaker::add_portion(const PlanarMapper& mapper, std::uint64_t entered, Grid& grid) {
  const std::uint64_t forgotten = entered - mapper.keyframes().size();
  grid.done = std::max(grid.done, forgotten);
  const std::uint64_t end = std::min(entered, grid.done + kPortion);
  for (; grid.done < end; ++grid.done) {
    const auto i = static_cast<std::size_t>(grid.done - forgotten);
    grid.cells.add(mapper.keyframes()[i].scan, mapper.keyframes()[i].T_map_base);
  }
}

OccupancyGrid GridMaker::snapshot() {
  has_changed_ = false;
  return shown_.cells.snapshot();
}

}  // namespace slamd
