#pragma once
// What a place looks like from above, whatever the heading: by it an earlier visit is found when the pose is no help.
// A candidate only: nothing is verified here.
// Source: Kim, Kim, "Scan Context" (2018), eq. (2)-(7), on sub-maps instead of single scans.

#include <array>
#include <cstdint>
#include <span>

#include "estimator/graph/keyframe_clouds.hpp"

namespace slamd {

struct PlaceDescriptor {
  static constexpr std::size_t kRings = 20;
  static constexpr std::size_t kSectors = 60;
  static constexpr float kReach_m = 50.0F;

  /// Height of what stands in each cell, 0..kMaxHeight_m in 1/255; 0 = ground or unseen. [sector][ring]
  std::array<std::array<std::uint8_t, kRings>, kSectors> heights{};
  /// Share of occupied sectors of each ring: does not change with the heading.
  std::array<float, kRings> ring_key{};
};

PlaceDescriptor describe(const Submap& submap);

struct PlaceMatch {
  std::size_t place = 0;     // index into `places`
  double distance = 1.0;     // 0 = equal, 1 = nothing in common
  double yaw_rad = 0.0;      // heading of the query in the place's frame, to a sector's width
};

/// Squared distance of the ring keys, by which matches are preselected.
float ring_key_distance(const PlaceDescriptor& a, const PlaceDescriptor& b);

/// The best turn of `query` on `place`; `place` of the result is 0.
PlaceMatch match(const PlaceDescriptor& place, const PlaceDescriptor& query);

}  // namespace slamd
