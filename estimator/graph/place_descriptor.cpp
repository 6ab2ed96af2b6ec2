#include "estimator/graph/place_descriptor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamd {

namespace {

constexpr float kMinHeight_m = 0.5F;  // above the footprint's ground: lower is road, kerb and slope
constexpr float kMaxHeight_m = 10.0F;

/// Cosine distance of two sectors, 1 - a.b / |a||b|; negative when one of them is empty.
double sector_distance(const std::array<std::uint8_t, PlaceDescriptor::kRings>& a,
                       const std::array<std::uint8_t, PlaceDescriptor::kRings>& b) {
  std::int64_t dot = 0;
  std::int64_t aa = 0;
  std::int64_t bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    dot += std::int64_t{a[i]} * b[i];
    aa += std::int64_t{a[i]} * a[i];
    bb += std::int64_t{b[i]} * b[i];
  }
  if (aa == 0 || bb == 0) return -1.0;
  return 1.0 - static_cast<double>(dot) / std::sqrt(static_cast<double>(aa) * static_cast<double>(bb));
}

double distance_at(const PlaceDescriptor& place, const PlaceDescriptor& query, std::size_t shift) {
  double sum = 0.0;
  std::size_t compared = 0;
  for (std::size_t s = 0; s < PlaceDescriptor::kSectors; ++s) {
    const double d = sector_distance(place.heights[(s + shift) % PlaceDescriptor::kSectors], query.heights[s]);
    if (d < 0.0) continue;
    sum += d;
    ++compared;
  }
  // A few sectors that happen to agree are no place.
  return compared >= PlaceDescriptor::kSectors / 4 ? sum / static_cast<double>(compared) : 1.0;
}

}  // namespace

PlaceDescriptor describe(const Submap& submap) {
  PlaceDescriptor d;
  for (const Eigen::Vector3f& p : submap.points) {
    const float range = std::hypot(p.x(), p.y());
    if (p.z() < kMinHeight_m || range >= PlaceDescriptor::kReach_m) continue;
    const float turn = std::atan2(p.y(), p.x()) / (2.0F * std::numbers::pi_v<float>) + 0.5F;
    const auto sector =
        std::min(static_cast<std::size_t>(turn * PlaceDescriptor::kSectors), PlaceDescriptor::kSectors - 1);
    const auto ring = static_cast<std::size_t>(range / PlaceDescriptor::kReach_m * PlaceDescriptor::kRings);
    const float height = std::min(p.z() / kMaxHeight_m, 1.0F);
    std::uint8_t& cell = d.heights[sector][std::min(ring, PlaceDescriptor::kRings - 1)];
    cell = std::max(cell, static_cast<std::uint8_t>(height * 255.0F));
  }
  for (std::size_t ring = 0; ring < PlaceDescriptor::kRings; ++ring) {
    const auto occupied = std::ranges::count_if(d.heights, [&](const auto& sector) { return sector[ring] > 0; });
    d.ring_key[ring] = static_cast<float>(occupied) / static_cast<float>(PlaceDescriptor::kSectors);
  }
  return d;
}

float ring_key_distance(const PlaceDescriptor& a, const PlaceDescriptor& b) {
  float sum = 0.0F;
  for (std::size_t i = 0; i < PlaceDescriptor::kRings; ++i) {
    const float difference = a.ring_key[i] - b.ring_key[i];
    sum += difference * difference;
  }
  return sum;
}

PlaceMatch match(const PlaceDescriptor& place, const PlaceDescriptor& query) {
  PlaceMatch best;
  for (std::size_t shift = 0; shift < PlaceDescriptor::kSectors; ++shift) {
    const double distance = distance_at(place, query, shift);
    if (distance >= best.distance) continue;
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(shift) / PlaceDescriptor::kSectors;
    best = {.distance = distance, .yaw_rad = std::remainder(turn, 2.0 * std::numbers::pi)};
  }
  return best;
}

}  // namespace slamd
