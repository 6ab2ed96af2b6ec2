#include "daemon/store/map_snapshot.hpp"

#include <algorithm>
#include <utility>

namespace slamd {
namespace {

CloudPoint placed(const Pose& T_map_base, const PackedPoint& point) {
  const Eigen::Vector3f p_map = (T_map_base * point.position().cast<double>()).cast<float>();
  return {p_map.x(), p_map.y(), p_map.z(), static_cast<float>(point.intensity())};
}

}  // namespace

void MapSnapshot::append(Part part) {
  const auto count = static_cast<std::size_t>(std::ranges::count(part.chosen, true));
  if (count == 0) return;
  part.begin = size_;
  size_ += count;
  parts_.push_back(std::move(part));
}

void MapSnapshot::read(std::size_t begin, std::span<CloudPoint> out) const {
  const auto after = std::upper_bound(parts_.begin(), parts_.end(), begin,
                                      [](std::size_t number, const Part& part) { return number < part.begin; });
  std::size_t written = 0;
  for (auto part = std::prev(after); written < out.size(); ++part) {
    std::size_t number = part->begin;
    for (std::size_t i = 0; i < part->points->size() && written < out.size(); ++i) {
      if (part->chosen[i] && number++ >= begin) out[written++] = placed(part->T_map_base, (*part->points)[i]);
    }
  }
}

PointCloud MapSnapshot::points() const {
  PointCloud all(size_);
  if (size_ > 0) read(0, all);
  return all;
}

CloudSource source_of(const MapSnapshot& snapshot) {
  return {snapshot.size(),
          [&snapshot](std::size_t begin, std::span<CloudPoint> out) { snapshot.read(begin, out); }};
}

}  // namespace slamd
