#pragma once
// Colours and gradients of the pictures. Knows nothing of what is drawn.

#include <vector>

namespace slamd::plot {

struct Colour {
  double red = 0.0;  // 0..1, sRGB
  double green = 0.0;
  double blue = 0.0;
  double alpha = 1.0;
};

/// 0xRRGGBB.
Colour rgb(unsigned hex, double alpha = 1.0);
/// a at share 0, b at share 1.
Colour mix(const Colour& a, const Colour& b, double share);

/// A piecewise linear run through evenly spaced colours.
class Gradient {
 public:
  explicit Gradient(std::vector<Colour> stops) : stops_{std::move(stops)} {}
  /// share is clamped to 0..1; a share that is no number gives the first colour.
  Colour at(double share) const;

 private:
  std::vector<Colour> stops_;
};

/// Deep blue over teal and yellow to red: small to large errors, readable on white and on black.
const Gradient& error_gradient();
/// Slate over teal and sand to near white: height above ground on a dark background.
const Gradient& height_gradient();

/// Colours of the lines of a chart, in order of use.
Colour series_colour(std::size_t index);

}  // namespace slamd::plot
