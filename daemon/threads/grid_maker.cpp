#include "daemon/threads/grid_maker.hpp"

#include <algorithm>
#include <utility>

namespace slamd {
namespace {

constexpr std::size_t kPortion = 8;  // keyframes

}  // namespace

void GridMaker::add(const PlanarScan& scan, const PlanarPose& T_map_base) {
  shown_.add(scan, T_map_base);
  has_changed_ = true;
}

void GridMaker::clear() {
  shown_.clear();
  is_making_ = is_outdated_ = false;
  has_changed_ = true;
}

bool GridMaker::work(const PlanarMapper& mapper) {
  if (!is_making_) {
    if (!std::exchange(is_outdated_, false)) return false;
    next_.clear();
    done_ = 0;
    is_making_ = true;
  }
  const std::size_t end = std::min(mapper.keyframes(), done_ + kPortion);
  for (; done_ < end; ++done_) next_.add(mapper.scan(done_), mapper.T_map_base(done_));
  if (done_ < mapper.keyframes()) return true;
  std::swap(shown_, next_);
  next_.clear();
  is_making_ = false;
  has_changed_ = true;
  return true;
}

OccupancyGrid GridMaker::snapshot() {
  has_changed_ = false;
  return shown_.snapshot();
}

}  // namespace slamd
