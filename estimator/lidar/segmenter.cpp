#include "estimator/lidar/segmenter.hpp"

#include <algorithm>
#include <cmath>

namespace slamd {

namespace {

float squared_distance(const float (&a)[3], const LidarPoint& b) {
  const float dx = a[0] - b.x;
  const float dy = a[1] - b.y;
  const float dz = a[2] - b.z;
  return dx * dx + dy * dy + dz * dz;
}

}  // namespace

void Segmenter::add(const LidarPoint& point, float time_s, std::vector<ScanSegment>& out) {
  const float squared_range = point.x * point.x + point.y * point.y + point.z * point.z;
  const bool in_range = squared_range >= config_.min_range_m * config_.min_range_m &&
                        squared_range <= config_.max_range_m * config_.max_range_m;
  if (!in_range || point.ring >= kMaxRings || point.return_index != 0) return;  // NaN fails the comparison
  Open& open = open_[point.ring];
  if (open.count > 0) {
    const float step2 = std::max(config_.max_step_m * config_.max_step_m,
                                 config_.max_step_per_range * config_.max_step_per_range * squared_range);
    const bool joins = squared_distance(open.last, point) <= step2 &&
                       squared_distance(open.first, point) <= config_.max_length_m * config_.max_length_m;
    if (!joins) close(point.ring, out);
  }
  const float position[3] = {point.x, point.y, point.z};
  if (open.count == 0) {
    open = {};
    std::copy_n(position, 3, open.first);
  }
  std::copy_n(position, 3, open.last);
  for (int i = 0; i < 3; ++i) open.sum[i] += position[i];
  open.time_sum_s += time_s;
  ++open.count;
}

void Segmenter::finish(std::vector<ScanSegment>& out) {
  for (std::size_t ring = 0; ring < kMaxRings; ++ring) {
    if (open_[ring].count > 0) close(static_cast<std::uint8_t>(ring), out);
  }
}

void Segmenter::close(std::uint8_t ring, std::vector<ScanSegment>& out) {
  Open& open = open_[ring];
  const float scale = 1.0F / static_cast<float>(open.count);
  ScanSegment segment{open.sum[0] * scale, open.sum[1] * scale, open.sum[2] * scale, open.time_sum_s * scale, 0.0F,
                      open.count, ring};
  segment.range_m = std::sqrt(segment.x * segment.x + segment.y * segment.y + segment.z * segment.z);
  open.count = 0;
  if (out.size() < out.capacity()) out.push_back(segment);
}

}  // namespace slamd
