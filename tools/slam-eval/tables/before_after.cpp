#include "tools/slam-eval/tables/before_after.hpp"

#include <algorithm>
#include <cstdio>

#include "tools/plot/line_chart.hpp"
#include "tools/plot/trajectory_plot.hpp"
#include "tools/slam-eval/alignment.hpp"
#include "tools/slam-eval/metrics.hpp"

namespace slamd::eval {
namespace {

constexpr int kWidthPx = 2400;
constexpr int kHeightPx = 760;
constexpr double kPanelPx = 800.0;

struct AlignedPath {
  std::string label;
  std::vector<plot::Point> truth;
  std::vector<plot::Point> estimate;
  std::vector<double> errors_m;
  double rmse_m = 0.0;
};

std::vector<plot::Point> top_down(const std::vector<Pose>& poses) {
  std::vector<plot::Point> points;
  points.reserve(poses.size());
  for (const Pose& pose : poses) points.push_back({pose.translation.x(), pose.translation.y()});
  return points;
}

AlignedPath align(const LabelledPath& path) {
  const MatchedPoses& poses = path.poses;
  const std::vector<Pose> estimate = aligned(fit(Alignment::kSe3Umeyama, poses.truth, poses.estimate), poses.estimate);
  AlignedPath result{path.label, top_down(poses.truth), top_down(estimate),
                     ape(poses.truth, estimate, PoseRelation::kTranslationPart), 0.0};
  result.rmse_m = statistics(result.errors_m).rmse;
  return result;
}

std::string with_rmse(const AlignedPath& path) {
  char text[160];
  std::snprintf(text, sizeof(text), "%s, APE RMSE %.4f m", path.label.c_str(), path.rmse_m);
  return text;
}

plot::LineChart errors_over_way(const std::vector<AlignedPath>& paths) {
  plot::LineChart chart;
  chart.labels = {"error over the way", "driven [m]", "error [m]"};
  for (std::size_t k = 0; k < paths.size(); ++k) {
    plot::Series curve{paths[k].label, {}, {plot::series_colour(k), 1.6}};
    double driven = 0.0;
    for (std::size_t i = 0; i < paths[k].errors_m.size(); ++i) {
      if (i > 0) driven += std::hypot(paths[k].truth[i].x - paths[k].truth[i - 1].x, paths[k].truth[i].y - paths[k].truth[i - 1].y);
      curve.points.push_back({driven, paths[k].errors_m[i]});
    }
    chart.series.push_back(std::move(curve));
  }
  return chart;
}

}  // namespace

void write_before_after(const std::string& title, const std::vector<LabelledPath>& paths, const std::string& png_path) {
  std::vector<AlignedPath> aligned_paths;
  for (const LabelledPath& path : paths) aligned_paths.push_back(align(path));
  const plot::Range range = plot::colour_range(aligned_paths.front().errors_m);
  const plot::Theme& theme = plot::light_theme();
  plot::Canvas canvas{kWidthPx, kHeightPx, theme.background};
  double left = 0.0;
  for (const AlignedPath* path : {&aligned_paths.front(), &aligned_paths.back()}) {
    const plot::TrajectoryPlot panel{{title + ": " + with_rmse(*path), "x [m]", "y [m]"},
                                     path->truth, {path->estimate, path->errors_m, range}, "error [m]"};
    plot::draw_trajectory_plot(canvas, {left, 0.0, kPanelPx, kHeightPx}, panel, theme);
    left += kPanelPx;
  }
  plot::draw_line_chart(canvas, {left, 0.0, kPanelPx, kHeightPx}, errors_over_way(aligned_paths), theme);
  canvas.save_png(png_path);
}

}  // namespace slamd::eval
