#include "tools/plot/axis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace slamd::plot {
namespace {

constexpr double kTickTextPx = 13.0;
constexpr double kTitlePx = 17.0;

double round_step(double rough) {
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (rough <= factor * power * (1.0 + 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

}  // namespace

void Range::include(double value) {
  if (!std::isfinite(value)) return;
  low = std::min(low, value);
  high = std::max(high, value);
}

Range empty_range() { return {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}; }

Range padded(Range range, double share) {
  if (!(range.low <= range.high)) return {0.0, 1.0};
  const double least = std::max(1e-9, 1e-9 * std::max(std::abs(range.low), std::abs(range.high)));
  const double margin = std::max(share * range.span(), range.span() < least ? 0.5 : 0.0);
  return {range.low - margin, range.high + margin};
}

Ticks round_ticks(const Range& range, int count) {
  Ticks ticks;
  ticks.step = round_step(range.span() / std::max(1, count));
  const double first = std::ceil(range.low / ticks.step - 1e-9);
  const double last = std::floor(range.high / ticks.step + 1e-9);
  for (double k = first; k <= last && ticks.values.size() < 100; k += 1.0) ticks.values.push_back(k * ticks.step);
  return ticks;
}

std::string tick_label(double value, double step) {
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, std::abs(value) < 1e-6 * step ? 0.0 : value);
  return text;
}

const Theme& light_theme() {
  static const Theme theme{rgb(0xFFFFFF), rgb(0x1F2933), rgb(0x616E7C), rgb(0xE4E7EB)};
  return theme;
}

const Theme& dark_theme() {
  static const Theme theme{rgb(0x0B1016), rgb(0xF0F4F8), rgb(0x9FB3C8), rgb(0x243B53)};
  return theme;
}

Frame equal_frame(const Rect& area, Range x, Range y) {
  const double unit_px = std::min(area.width / x.span(), area.height / y.span());
  const auto widened = [unit_px](const Range& r, double length_px) {
    const double middle = 0.5 * (r.low + r.high);
    const double half = 0.5 * length_px / unit_px;
    return Range{middle - half, middle + half};
  };
  return {area, widened(x, area.width), widened(y, area.height)};
}

Rect inside_axes(const Rect& outer) { return {outer.x + 78.0, outer.y + 46.0, outer.width - 96.0, outer.height - 104.0}; }

void draw_axes(Canvas& canvas, const Frame& frame, const AxisLabels& labels, const Theme& theme) {
  const Rect& a = frame.area;
  const Stroke grid{theme.grid, 1.0};
  const TextStyle below{kTickTextPx, theme.faint, Align::kMiddle, Align::kBegin};
  const TextStyle beside{kTickTextPx, theme.faint, Align::kEnd, Align::kMiddle};
  const Ticks x_ticks = round_ticks(frame.x, static_cast<int>(a.width / 90.0));
  for (const double x : x_ticks.values) {
    const double px = frame.at(x, frame.y.low).x;
    canvas.line({px, a.y}, {px, a.bottom()}, grid);
    canvas.text({px, a.bottom() + 9.0}, tick_label(x, x_ticks.step), below);
  }
  const Ticks y_ticks = round_ticks(frame.y, static_cast<int>(a.height / 55.0));
  for (const double y : y_ticks.values) {
    const double py = frame.at(frame.x.low, y).y;
    canvas.line({a.x, py}, {a.right(), py}, grid);
    canvas.text({a.x - 9.0, py}, tick_label(y, y_ticks.step), beside);
  }
  canvas.frame(a, {mix(theme.grid, theme.faint, 0.4), 1.0});
  const TextStyle axis_title{14.0, theme.ink, Align::kMiddle, Align::kBegin};
  canvas.text({a.x + 0.5 * a.width, a.bottom() + 33.0}, labels.x, axis_title);
  TextStyle upwards = axis_title;
  upwards.upwards = true;
  canvas.text({a.x - 70.0, a.y + 0.5 * a.height}, labels.y, upwards);
  canvas.text({a.x, a.y - 16.0}, labels.title, {kTitlePx, theme.ink, Align::kBegin, Align::kEnd, true});
}

}  // namespace slamd::plot
