#include "tools/plot/colour.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace slamd::plot {

Colour rgb(unsigned hex, double alpha) {
  const auto channel = [hex](unsigned shift) { return static_cast<double>((hex >> shift) & 0xFFU) / 255.0; };
  return {channel(16), channel(8), channel(0), alpha};
}

Colour mix(const Colour& a, const Colour& b, double share) {
  const auto blend = [share](double from, double to) { return from + share * (to - from); };
  return {blend(a.red, b.red), blend(a.green, b.green), blend(a.blue, b.blue), blend(a.alpha, b.alpha)};
}

Colour Gradient::at(double share) const {
  const double last = static_cast<double>(stops_.size() - 1);
  const double place = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) * last : 0.0;
  const double below = std::min(std::floor(place), last - 1.0);
  const auto i = static_cast<std::size_t>(below);
  return mix(stops_[i], stops_[i + 1], place - below);
}

const Gradient& error_gradient() {
  static const Gradient gradient({rgb(0x2B4FB8), rgb(0x1E9BC7), rgb(0x35C28B), rgb(0xE8D33F), rgb(0xF28C28), rgb(0xD7263D)});
  return gradient;
}

const Gradient& height_gradient() {
  static const Gradient gradient({rgb(0x2E4A6B), rgb(0x2F7F8F), rgb(0x56B48C), rgb(0xC9D36A), rgb(0xF4B860), rgb(0xFFF3DC)});
  return gradient;
}

Colour series_colour(std::size_t index) {
  static const std::array colours{rgb(0x2B6CB0), rgb(0xD9622B), rgb(0x2F9E62), rgb(0x8E4EC6), rgb(0xC2255C), rgb(0x5C6B7A)};
  return colours[index % colours.size()];
}

}  // namespace slamd::plot
