#pragma once
// A keyframe's point in eight bytes: what the map keeps. The keyframe's pose gives it its place.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "estimator/types/point_cloud.hpp"

namespace slamd {

struct PackedPoint {
  static constexpr float kUnit_m = 0.005F;   // worst rounding 2.5 mm an axis
  static constexpr float kReach_m = 160.0F;  // 16 bits of the unit end at 163.8 m

  std::int16_t x, y, z;  // base frame, in kUnit_m
  std::uint16_t intensity;

  /// None for a point that is not finite or beyond kReach_m on an axis.
  static std::optional<PackedPoint> of(const CloudPoint& point) {
    const auto fits = [](float coordinate) { return std::abs(coordinate) <= kReach_m; };  // NaN does not
    if (!fits(point.x) || !fits(point.y) || !fits(point.z)) return std::nullopt;
    const auto units = [](float coordinate) { return static_cast<std::int16_t>(std::lround(coordinate / kUnit_m)); };
    const float intensity = std::isfinite(point.intensity) ? std::clamp(point.intensity, 0.0F, 255.0F) : 0.0F;
    return PackedPoint{units(point.x), units(point.y), units(point.z), static_cast<std::uint16_t>(intensity)};
  }

  /// Base frame, metres.
  Eigen::Vector3f position() const {
    return Eigen::Vector3f{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)} * kUnit_m;
  }
};
static_assert(sizeof(PackedPoint) == 8);

using PackedPoints = std::vector<PackedPoint>;

}  // namespace slamd
