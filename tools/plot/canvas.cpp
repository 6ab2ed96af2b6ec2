#include "tools/plot/canvas.hpp"

#include <cairo.h>

#include <cstring>
#include <numbers>

namespace slamd::plot {
namespace {

void set_source(cairo_t* cr, const Colour& c) { cairo_set_source_rgba(cr, c.red, c.green, c.blue, c.alpha); }

void rounded_path(cairo_t* cr, const Rect& r, double radius) {
  constexpr double kQuarter = std::numbers::pi / 2.0;
  cairo_new_sub_path(cr);
  cairo_arc(cr, r.right() - radius, r.y + radius, radius, -kQuarter, 0.0);
  cairo_arc(cr, r.right() - radius, r.bottom() - radius, radius, 0.0, kQuarter);
  cairo_arc(cr, r.x + radius, r.bottom() - radius, radius, kQuarter, 2.0 * kQuarter);
  cairo_arc(cr, r.x + radius, r.y + radius, radius, 2.0 * kQuarter, 3.0 * kQuarter);
  cairo_close_path(cr);
}

double shift(Align align, double length) {
  return align == Align::kBegin ? 0.0 : (align == Align::kMiddle ? -0.5 * length : -length);
}

}  // namespace

Canvas::Canvas(int width_px, int height_px, const Colour& background)
    : width_px_{static_cast<double>(width_px)},
      height_px_{static_cast<double>(height_px)},
      surface_{cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width_px, height_px), cairo_surface_destroy},
      cairo_{cairo_create(surface_.get()), cairo_destroy} {
  if (cairo_status(cairo_.get()) != CAIRO_STATUS_SUCCESS) {
    throw PlotError(std::string("no drawing surface: ") + cairo_status_to_string(cairo_status(cairo_.get())));
  }
  cairo_set_line_join(cairo_.get(), CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(cairo_.get(), CAIRO_LINE_CAP_ROUND);
  fill(area(), background);
}

void Canvas::apply(const Stroke& stroke) {
  set_source(cairo_.get(), stroke.colour);
  cairo_set_line_width(cairo_.get(), stroke.width_px);
  cairo_set_dash(cairo_.get(), stroke.dashes_px.data(), static_cast<int>(stroke.dashes_px.size()), 0.0);
}

void Canvas::apply(const TextStyle& style) {
  cairo_select_font_face(cairo_.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo_.get(), style.size_px);
}

void Canvas::line(Point from, Point to, const Stroke& stroke) {
  apply(stroke);
  cairo_move_to(cairo_.get(), from.x, from.y);
  cairo_line_to(cairo_.get(), to.x, to.y);
  cairo_stroke(cairo_.get());
}

void Canvas::polyline(std::span<const Point> points, const Stroke& stroke) {
  if (points.size() < 2) return;
  apply(stroke);
  for (const Point& p : points) cairo_line_to(cairo_.get(), p.x, p.y);
  cairo_stroke(cairo_.get());
}

void Canvas::fill(const Rect& rect, const Colour& colour, double corner_radius_px) {
  set_source(cairo_.get(), colour);
  if (corner_radius_px > 0.0) {
    rounded_path(cairo_.get(), rect, corner_radius_px);
  } else {
    cairo_rectangle(cairo_.get(), rect.x, rect.y, rect.width, rect.height);
  }
  cairo_fill(cairo_.get());
}

void Canvas::frame(const Rect& rect, const Stroke& stroke) {
  apply(stroke);
  cairo_rectangle(cairo_.get(), rect.x, rect.y, rect.width, rect.height);
  cairo_stroke(cairo_.get());
}

void Canvas::disc(Point centre, double radius_px, const Colour& colour) {
  set_source(cairo_.get(), colour);
  cairo_arc(cairo_.get(), centre.x, centre.y, radius_px, 0.0, 2.0 * std::numbers::pi);
  cairo_fill(cairo_.get());
}

void Canvas::text(Point at, const std::string& words, const TextStyle& style) {
  apply(style);
  const double capitals_px = 0.73 * style.size_px;  // DejaVu's capital height
  const double drop = style.vertical == Align::kEnd ? 0.0 : capitals_px * (style.vertical == Align::kBegin ? 1.0 : 0.5);
  cairo_save(cairo_.get());
  cairo_translate(cairo_.get(), at.x, at.y);
  if (style.upwards) cairo_rotate(cairo_.get(), -std::numbers::pi / 2.0);
  cairo_move_to(cairo_.get(), shift(style.horizontal, text_width(words, style)), drop);
  set_source(cairo_.get(), style.colour);
  cairo_show_text(cairo_.get(), words.c_str());
  cairo_restore(cairo_.get());
}

double Canvas::text_width(const std::string& words, const TextStyle& style) {
  apply(style);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo_.get(), words.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::image(std::span<const std::uint32_t> pixels, int columns, const Rect& into) {
  if (columns <= 0 || pixels.empty()) return;
  const int rows = static_cast<int>(pixels.size()) / columns;
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> source{
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, columns, rows), cairo_surface_destroy};
  cairo_surface_flush(source.get());
  unsigned char* bytes = cairo_image_surface_get_data(source.get());
  if (bytes == nullptr) throw PlotError("no drawing surface of that size");
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(source.get()));
  const auto width = static_cast<std::size_t>(columns);
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row) {
    std::memcpy(bytes + row * stride, pixels.data() + row * width, width * sizeof(std::uint32_t));
  }
  cairo_surface_mark_dirty(source.get());
  cairo_save(cairo_.get());
  cairo_translate(cairo_.get(), into.x, into.y);
  cairo_scale(cairo_.get(), into.width / columns, into.height / rows);
  cairo_set_source_surface(cairo_.get(), source.get(), 0.0, 0.0);
  cairo_pattern_set_filter(cairo_get_source(cairo_.get()), CAIRO_FILTER_BEST);
  cairo_paint(cairo_.get());
  cairo_restore(cairo_.get());
}

void Canvas::begin_clip(const Rect& rect) {
  cairo_save(cairo_.get());
  cairo_rectangle(cairo_.get(), rect.x, rect.y, rect.width, rect.height);
  cairo_clip(cairo_.get());
}

void Canvas::end_clip() { cairo_restore(cairo_.get()); }

void Canvas::save_png(const std::string& path) const {
  const cairo_status_t status = cairo_surface_write_to_png(surface_.get(), path.c_str());
  if (status != CAIRO_STATUS_SUCCESS) {
    throw PlotError(path + ": cannot be written: " + cairo_status_to_string(status));
  }
}

}  // namespace slamd::plot
