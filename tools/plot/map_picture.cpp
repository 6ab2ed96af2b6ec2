#include "tools/plot/map_picture.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::plot {
namespace {

constexpr double kMarginM = 45.0;  // of map around the trajectory
constexpr double kHeaderPx = 84.0;
constexpr double kBarsPx = 120.0;

struct Extent {
  Range x = empty_range();
  Range y = empty_range();

  void include(double px, double py) {
    x.include(px);
    y.include(py);
  }
};

// The trajectory with a margin, cut to where there are points; all points when there is no trajectory.
Extent extent_of(const MapPicture& picture) {
  Extent map;
  for (const CloudPoint& p : picture.points) map.include(p.x, p.y);
  if (picture.path.points.empty()) return {padded(map.x, 0.03), padded(map.y, 0.03)};
  Extent drive;
  for (const Point& p : picture.path.points) drive.include(p.x, p.y);
  const auto cut = [](const Range& d, const Range& m) {
    return padded({std::max(d.low - kMarginM, std::min(d.low - 3.0, m.low)),
                   std::min(d.high + kMarginM, std::max(d.high + 3.0, m.high))}, 0.0);
  };
  return {cut(drive.x, map.x), cut(drive.y, map.y)};
}

int height_for(const Extent& extent, int width_px) {
  const double map_px = (width_px - kBarsPx) * extent.y.span() / extent.x.span();
  return static_cast<int>(std::clamp(map_px + kHeaderPx, 0.45 * width_px, 1.1 * width_px));
}

void draw_paths(Canvas& canvas, const Frame& frame, const MapPicture& picture, const Theme& theme) {
  std::vector<Point> truth;
  for (const Point& p : picture.truth) truth.push_back(frame.at(p.x, p.y));
  std::vector<Point> path;
  for (const Point& p : picture.path.points) path.push_back(frame.at(p.x, p.y));
  Colour casing = theme.background;
  casing.alpha = 0.75;
  if (picture.path.values.empty()) {
    canvas.polyline(path, {casing, 6.5});
    canvas.polyline(path, {rgb(0xFF5D5D), 3.0});
  } else {
    draw_coloured_path(canvas, frame, picture.path, 3.5, casing);
  }
  canvas.polyline(truth, {rgb(0xFFFFFF, 0.85), 1.0, {4.0, 6.0}});
  if (path.empty()) return;
  for (const auto& [at, words] : {std::pair{path.front(), "start"}, std::pair{path.back(), "end"}}) {
    canvas.disc(at, 7.5, casing);
    canvas.disc(at, 5.0, theme.ink);
    canvas.text({at.x + 11.0, at.y + (words[0] == 's' ? -11.0 : 18.0)}, words, {14.0, theme.ink, Align::kBegin, Align::kEnd, true});
  }
}

void draw_scale_bar(Canvas& canvas, const Frame& frame, const Theme& theme) {
  const double length_m = round_ticks({0.0, 0.22 * frame.x.span()}, 1).step;
  const double length_px = length_m * frame.px_per_unit();
  const Point left{frame.area.x + 26.0, frame.area.bottom() - 26.0};
  Colour veil = theme.background;
  veil.alpha = 0.7;
  canvas.fill({left.x - 14.0, left.y - 30.0, length_px + 28.0, 44.0}, veil, 6.0);
  canvas.line(left, {left.x + length_px, left.y}, {theme.ink, 2.5});
  for (const double x : {left.x, left.x + length_px}) canvas.line({x, left.y - 5.0}, {x, left.y + 5.0}, {theme.ink, 2.5});
  canvas.text({left.x + 0.5 * length_px, left.y - 10.0}, tick_label(length_m, length_m) + " m",
              {14.0, theme.ink, Align::kMiddle});
}

void draw_bars(Canvas& canvas, const Frame& frame, const MapPicture& picture, const Range& map_range, const Theme& theme) {
  const double x = frame.area.right() + 26.0;
  const bool two = !picture.path.values.empty();
  const double length = std::min(360.0, (frame.area.height - (two ? 130.0 : 70.0)) / (two ? 2.0 : 1.0));
  const std::string map_label = picture.colour == MapColour::kHeight ? "height [m]" : "intensity";
  double y = frame.area.y + 34.0;
  if (two) {
    draw_colour_bar(canvas, {x, y, 16.0, length}, {picture.path.range, picture.value_label, error_gradient()}, theme);
    y += length + 64.0;
  }
  draw_colour_bar(canvas, {x, y, 16.0, length}, {map_range, map_label, height_gradient(), true}, theme);
}

}  // namespace

void write_map_picture(const MapPicture& picture, const std::string& path) {
  const Theme& theme = dark_theme();
  const Extent extent = extent_of(picture);
  const int height_px = height_for(extent, picture.width_px);
  Canvas canvas(picture.width_px, height_px, theme.background);
  const Frame frame = equal_frame({0.0, kHeaderPx, picture.width_px - kBarsPx, height_px - kHeaderPx}, extent.x, extent.y);
  const std::vector<float> values = map_values(picture.points, picture.colour);
  const Range range = map_value_range(values);
  const auto pixels = rasterise(picture.points, values, frame, {.range = range});
  canvas.image(pixels, static_cast<int>(frame.area.width), frame.area);
  canvas.clipped(frame.area, [&] { draw_paths(canvas, frame, picture, theme); });
  draw_scale_bar(canvas, frame, theme);
  draw_bars(canvas, frame, picture, range, theme);
  canvas.text({28.0, 40.0}, picture.title, {25.0, theme.ink, Align::kBegin, Align::kEnd, true});
  canvas.text({28.0, 66.0}, picture.subtitle, {15.0, theme.faint});
  canvas.save_png(path);
}

}  // namespace slamd::plot
