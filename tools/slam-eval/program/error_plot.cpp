#include "tools/slam-eval/program/error_plot.hpp"

#include <cstdio>

#include "tools/plot/line_chart.hpp"
#include "tools/plot/trajectory_plot.hpp"

namespace slamd::eval {
namespace {

constexpr int kWidthPx = 1700;
constexpr int kHeightPx = 760;
constexpr double kTrajectoryWidthPx = 860.0;

std::string value_label(PoseRelation relation) {
  const std::string text = unit(relation);
  return text.empty() ? "error" : "error [" + text + "]";
}

std::string with_value(const char* word, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), "%s %.4g", word, value);
  return text;
}

std::vector<plot::Point> top_down(const std::vector<Pose>& poses) {
  std::vector<plot::Point> points;
  points.reserve(poses.size());
  for (const Pose& pose : poses) points.push_back({pose.translation.x(), pose.translation.y()});
  return points;
}

plot::TrajectoryPlot trajectory_of(const ErrorPlot& p) {
  return {{p.metric + " " + name(p.row.relation), "x [m]", "y [m]"},
          top_down(p.truth),
          {top_down(p.poses), p.errors, plot::colour_range(p.errors)},
          value_label(p.row.relation)};
}

plot::LineChart chart_of(const ErrorPlot& p) {
  const bool timed = !p.stamps_s.empty();
  plot::Series curve{"", {}, {plot::series_colour(0), 1.4}};
  for (std::size_t i = 0; i < p.errors.size(); ++i) {
    curve.points.push_back({timed ? p.stamps_s[i] - p.stamps_s.front() : static_cast<double>(i), p.errors[i]});
  }
  const double last = curve.points.back().x;
  const Statistics& s = p.row.statistics;
  plot::LineChart chart;
  chart.labels = {"error over the drive", timed ? "time [s]" : "pose", value_label(p.row.relation)};
  chart.series = {curve, plot::level(with_value("rmse", s.rmse), s.rmse, 0.0, last, plot::series_colour(4)),
                  plot::level(with_value("mean", s.mean), s.mean, 0.0, last, plot::series_colour(2)),
                  plot::level(with_value("median", s.median), s.median, 0.0, last, plot::series_colour(1))};
  return chart;
}

}  // namespace

void write_error_plot(const ErrorPlot& p, const std::string& path) {
  const plot::Theme& theme = plot::light_theme();
  plot::Canvas canvas(kWidthPx, kHeightPx, theme.background);
  plot::draw_trajectory_plot(canvas, {0.0, 0.0, kTrajectoryWidthPx, kHeightPx}, trajectory_of(p), theme);
  plot::draw_line_chart(canvas, {kTrajectoryWidthPx, 0.0, kWidthPx - kTrajectoryWidthPx, kHeightPx}, chart_of(p), theme);
  canvas.save_png(path);
}

}  // namespace slamd::eval
