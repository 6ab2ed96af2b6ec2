#include "tools/slam-sim/world/bvh.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace slamd::sim {
namespace {

constexpr std::uint32_t kLeafBodies = 2;
constexpr int kBins = 16;
constexpr double kMiss = std::numeric_limits<double>::infinity();

/// Entry distance of the ray into the box (0 when inside), or kMiss.
double entry(const Eigen::AlignedBox3d& box, const Ray& ray, double limit) {
  double enter = 0.0;
  double leave = limit;
  for (int i = 0; i < 3; ++i) {
    const double a = (box.min()[i] - ray.origin[i]) * ray.inverse[i];
    const double b = (box.max()[i] - ray.origin[i]) * ray.inverse[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? enter : kMiss;
}

double half_area(const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return 0.0;
  const Eigen::Vector3d s = box.sizes();
  return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
}

}  // namespace

Bvh::Bvh(std::vector<Primitive> bodies) : bodies_{std::move(bodies)} {
  nodes_.reserve(2 * bodies_.size() + 1);
  if (!bodies_.empty()) build(0, static_cast<std::uint32_t>(bodies_.size()));
}

void Bvh::build(std::uint32_t first, std::uint32_t count) {
  const std::size_t self = nodes_.size();
  nodes_.emplace_back();
  Eigen::AlignedBox3d box;
  for (std::uint32_t i = first; i < first + count; ++i) box.extend(bodies_[i].bounds());
  // A margin keeps rays that run exactly along a face inside.
  nodes_[self].box = {box.min().array() - 1e-9, box.max().array() + 1e-9};
  if (count <= kLeafBodies) {
    nodes_[self].first = first;
    nodes_[self].count = count;
    return;
  }
  const std::uint32_t left = partition(first, count);
  build(first, left);
  nodes_[self].first = static_cast<std::uint32_t>(nodes_.size());
  build(first + left, count - left);
}

/// Orders the bodies of the range around the binned surface-area split of the longest axis; returns the left count.
std::uint32_t Bvh::partition(std::uint32_t first, std::uint32_t count) {
  Eigen::AlignedBox3d centres;
  for (std::uint32_t i = first; i < first + count; ++i) centres.extend(bodies_[i].centre);
  Eigen::Index axis = 0;
  const double width = centres.sizes().maxCoeff(&axis);
  const auto begin = bodies_.begin() + first;
  const auto end = begin + count;
  const auto bin_of = [&](const Primitive& body) {
    return std::min(kBins - 1, static_cast<int>((body.centre[axis] - centres.min()[axis]) / width * kBins));
  };
  int best_bin = 0;
  if (width > 1e-9) {
    std::array<Eigen::AlignedBox3d, kBins> boxes;
    std::array<int, kBins> counts{};
    for (auto body = begin; body != end; ++body) {
      boxes[static_cast<std::size_t>(bin_of(*body))].extend(body->bounds());
      ++counts[static_cast<std::size_t>(bin_of(*body))];
    }
    double best_cost = kMiss;
    for (int split = 1; split < kBins; ++split) {
      Eigen::AlignedBox3d low, high;
      int low_count = 0;
      for (int bin = 0; bin < kBins; ++bin) {
        (bin < split ? low : high).extend(boxes[static_cast<std::size_t>(bin)]);
        if (bin < split) low_count += counts[static_cast<std::size_t>(bin)];
      }
      const int high_count = static_cast<int>(count) - low_count;
      const double cost = half_area(low) * low_count + half_area(high) * high_count;
      if (low_count > 0 && high_count > 0 && cost < best_cost) {
        best_cost = cost;
        best_bin = split;
      }
    }
  }
  auto middle = std::stable_partition(begin, end, [&](const Primitive& body) { return bin_of(body) < best_bin; });
  if (best_bin == 0) middle = begin + count / 2;
  return static_cast<std::uint32_t>(middle - begin);
}

void Bvh::cast(const Ray& ray, Hit& hit) const {
  if (nodes_.empty()) return;
  std::array<std::uint32_t, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t index = stack[--depth];
    const Node& node = nodes_[index];
    if (entry(node.box, ray, std::min(hit.range, ray.max_range)) == kMiss) continue;
    if (node.count > 0) {
      for (std::uint32_t i = 0; i < node.count; ++i) intersect(bodies_[node.first + i], ray, hit);
      continue;
    }
    const double left = entry(nodes_[index + 1].box, ray, ray.max_range);
    const double right = entry(nodes_[node.first].box, ray, ray.max_range);
    if (left <= right) {
      if (right != kMiss) stack[depth++] = node.first;
      if (left != kMiss) stack[depth++] = index + 1;
    } else {
      if (left != kMiss) stack[depth++] = index + 1;
      stack[depth++] = node.first;
    }
  }
}

}  // namespace slamd::sim
