// The picture of rest_recording: two log-log charts side by side.

#include <cmath>

#include "tools/imu-monitor/rest_recording.hpp"
#include "tools/plot/line_chart.hpp"

namespace slamd::monitor {
namespace {

constexpr int kWidthPx = 1500;
constexpr int kHeightPx = 640;
constexpr const char* kNames[] = {"x", "y", "z"};

std::string with_figures(const char* axis, const AllanFigures& f) {
  char text[80];
  std::snprintf(text, sizeof text, "%s: N %.2e  B %.2e", axis, f.noise_density, f.bias_instability);
  return text;
}

/// The -1/2 slope of the noise density, dashed.
plot::Series slope_of(const AllanAxis& axis, const plot::Colour& colour) {
  plot::Series series{"", {}, {colour, 1.0, {5.0, 5.0}}};
  for (const AllanPoint& p : axis.curve) {
    const double y = axis.figures.noise_density / std::sqrt(p.tau_s);
    if (y >= 0.5 * axis.figures.bias_instability) series.points.push_back({std::log10(p.tau_s), std::log10(y)});
  }
  return series;
}

plot::LineChart chart_of(const AllanResult& result, std::size_t first, const plot::AxisLabels& labels) {
  plot::LineChart chart;
  chart.labels = labels;
  chart.y_from_zero = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const AllanAxis& axis = result[first + i];
    const plot::Colour colour = plot::series_colour(i);
    plot::Series curve{with_figures(kNames[i], axis.figures), {}, {colour, 1.8}};
    for (const AllanPoint& p : axis.curve) curve.points.push_back({std::log10(p.tau_s), std::log10(p.deviation)});
    chart.series.push_back(slope_of(axis, colour));
    chart.series.push_back(curve);
  }
  return chart;
}

}  // namespace

void draw_allan(const AllanResult& result, const std::string& path) {
  const plot::Theme& theme = plot::light_theme();
  plot::Canvas canvas(kWidthPx, kHeightPx, theme.background);
  const double half = 0.5 * kWidthPx;
  const auto height = static_cast<double>(kHeightPx);
  plot::draw_line_chart(canvas, {0.0, 0.0, half, height},
                        chart_of(result, 0, {"Allan deviation, gyroscope", "log10 of tau [s]", "log10 of rad/s"}),
                        theme);
  plot::draw_line_chart(canvas, {half, 0.0, half, height},
                        chart_of(result, 3, {"Allan deviation, accelerometer", "log10 of tau [s]", "log10 of m/s^2"}),
                        theme);
  canvas.save_png(path);
}

}  // namespace slamd::monitor
