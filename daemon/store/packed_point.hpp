#pragma once
// A keyframe's point in seven bytes: what the map keeps. The keyframe's pose gives it its place.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "estimator/types/point_cloud.hpp"

namespace slamd {

class PackedPoint {
 public:
  static constexpr float kUnit_m = 0.005F;   // worst rounding 2.5 mm an axis
  static constexpr float kReach_m = 160.0F;  // 16 bits of the unit end at 163.8 m

  /// None for a point that is not finite or beyond kReach_m on an axis.
  static std::optional<PackedPoint> of(const CloudPoint& point) {
    const auto fits = [](float coordinate) { return std::abs(coordinate) <= kReach_m; };  // NaN does not
    if (!fits(point.x) || !fits(point.y) || !fits(point.z)) return std::nullopt;
    const auto units = [](float coordinate) { return static_cast<std::int16_t>(std::lround(coordinate / kUnit_m)); };
    const Units place{units(point.x), units(point.y), units(point.z)};
    PackedPoint packed;
    std::memcpy(packed.place_.data(), place.data(), sizeof place);
    packed.intensity_ = static_cast<std::uint8_t>(std::isfinite(point.intensity) ? std::clamp(point.intensity, 0.0F, 255.0F) : 0.0F);
    return packed;
  }

  /// Base frame, metres.
  Eigen::Vector3f position() const {
    Units place;
    std::memcpy(place.data(), place_.data(), sizeof place);
    return Eigen::Vector3f{static_cast<float>(place[0]), static_cast<float>(place[1]), static_cast<float>(place[2])} * kUnit_m;
  }

  /// 0..255, cut to a whole number.
  std::uint8_t intensity() const { return intensity_; }

 private:
  using Units = std::array<std::int16_t, 3>;  // x, y, z, base frame, in kUnit_m

  std::array<std::uint8_t, sizeof(Units)> place_{};  // bytes, for those need no alignment
  std::uint8_t intensity_ = 0;
};
static_assert(sizeof(PackedPoint) == 7);

using PackedPoints = std::vector<PackedPoint>;

}  // namespace slamd
