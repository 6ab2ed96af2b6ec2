#pragma once
// A drawing surface in pixels, y downwards, saved as PNG: a thin owner of cairo. It knows no axes and no data.

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/plot/colour.hpp"

typedef struct _cairo cairo_t;  // cairo's own names, so that its header stays in one .cpp
typedef struct _cairo_surface cairo_surface_t;

namespace slamd::plot {

/// A picture that cannot be drawn or written; what() says which file and why.
class PlotError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Point {
  double x = 0.0;
  double y = 0.0;
};

struct Rect {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;

  double right() const { return x + width; }
  double bottom() const { return y + height; }
};

struct Stroke {
  Colour colour;
  double width_px = 1.0;
  std::vector<double> dashes_px = {};  // lengths on, off, ...; empty = solid
};

enum class Align { kBegin, kMiddle, kEnd };

struct TextStyle {
  double size_px = 14.0;
  Colour colour;
  Align horizontal = Align::kBegin;  // which part of the text stands at the point
  Align vertical = Align::kEnd;      // kBegin: the point is on its top, kEnd: on its baseline
  bool bold = false;
  bool upwards = false;  // turned 90 degrees counter-clockwise
};

class Canvas {
 public:
  /// Throws PlotError when cairo cannot make a surface of that size.
  Canvas(int width_px, int height_px, const Colour& background);

  Rect area() const { return {0.0, 0.0, width_px_, height_px_}; }
  void line(Point from, Point to, const Stroke& stroke);
  void polyline(std::span<const Point> points, const Stroke& stroke);
  void fill(const Rect& rect, const Colour& colour, double corner_radius_px = 0.0);
  void frame(const Rect& rect, const Stroke& stroke);
  void disc(Point centre, double radius_px, const Colour& colour);
  void text(Point at, const std::string& words, const TextStyle& style);
  double text_width(const std::string& words, const TextStyle& style);

  /// Draws an image of 0xAARRGGBB (premultiplied) pixels, row-major, scaled into `into`.
  void image(std::span<const std::uint32_t> pixels, int columns, const Rect& into);

  /// Runs `draw` with everything outside of `rect` cut off.
  template <class Draw>
  void clipped(const Rect& rect, Draw draw) {
    begin_clip(rect);
    draw();
    end_clip();
  }

  /// Throws PlotError when the file cannot be written.
  void save_png(const std::string& path) const;

 private:
  void begin_clip(const Rect& rect);
  void end_clip();
  void apply(const Stroke& stroke);
  void apply(const TextStyle& style);

  double width_px_;
  double height_px_;
  std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
  std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo_;
};

}  // namespace slamd::plot
