// slam-eval picture: a map from above with the trajectory on it, coloured by error when there is a truth.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>

#include "tools/plot/grid_picture.hpp"
#include "tools/plot/map_picture.hpp"
#include "tools/plot/pcd_file.hpp"
#include "tools/slam-eval/program/commands.hpp"
#include "tools/slam-eval/tables/drawn_path.hpp"

namespace slamd::eval {
namespace {

const std::map<std::string, plot::MapColour> kMapColours{{"height", plot::MapColour::kHeight},
                                                         {"intensity", plot::MapColour::kIntensity}};

struct PictureOptions {
  std::string map_path;
  std::string trajectory_path;
  std::string truth_path;
  std::string out_path;
  std::string title = "slamd";
  plot::MapColour colour = plot::MapColour::kHeight;
  int width_px = 1800;
  AssociationOptions association{.interpolate = true};
};

plot::Point top_down(const Pose& pose) { return {pose.translation.x(), pose.translation.y()}; }

double length_m(const std::vector<Pose>& poses) {
  double sum = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) sum += (poses[i].translation - poses[i - 1].translation).norm();
  return sum;
}

template <class... Values>
std::string text(const char* pattern, Values... values) {
  char line[160];
  std::snprintf(line, sizeof(line), pattern, values...);
  return line;
}

std::string point_count(std::size_t count) {
  const double n = static_cast<double>(count);
  return n < 1e6 ? text("%.0f thousand map points", n / 1e3) : text("%.1f million map points", n / 1e6);
}

/// What is drawn on a map: the path, by error when there is a truth.
struct Overlay {
  DrawnPath drawn;
  std::string words;
};

Overlay overlay_of(const PictureOptions& o) {
  Overlay overlay;
  if (o.trajectory_path.empty()) return overlay;
  const Trajectory trajectory = load_trajectory(o.trajectory_path, guess_format(o.trajectory_path));
  overlay.words = text("%.0f m driven  ·  ", length_m(trajectory.poses));
  if (o.truth_path.empty()) {
    for (const Pose& pose : trajectory.poses) overlay.drawn.path.points.push_back(top_down(pose));
    return overlay;
  }
  const Trajectory truth = load_trajectory(o.truth_path, guess_format(o.truth_path));
  overlay.drawn = path_by_error(associate(truth, trajectory, o.association));
  overlay.words += text("APE RMSE %.3f m, worst %.3f m  ·  ", overlay.drawn.ape.rmse, overlay.drawn.ape.max);
  return overlay;
}

void draw_cloud(const PictureOptions& o, Overlay overlay) {
  plot::MapPicture picture;
  picture.points = plot::read_pcd(o.map_path);
  picture.colour = o.colour;
  picture.title = o.title;
  picture.width_px = o.width_px;
  picture.subtitle = overlay.words + point_count(picture.points.size());
  picture.value_label = "error [m]";
  picture.path = std::move(overlay.drawn.path);
  picture.truth = std::move(overlay.drawn.truth);
  plot::write_map_picture(picture, o.out_path);
}

void draw_grid(const PictureOptions& o, Overlay overlay) {
  plot::GridPicture picture{plot::load_grid(o.map_path), std::move(overlay.drawn.path), o.title, "", "error [m]", o.width_px};
  picture.subtitle = overlay.words + text("%.2f m a cell", picture.grid.resolution_m);
  plot::write_grid_picture(picture, o.out_path);
}

void run_picture(const PictureOptions& o) {
  const bool is_grid = o.map_path.ends_with(".yaml");
  is_grid ? draw_grid(o, overlay_of(o)) : draw_cloud(o, overlay_of(o));
  std::cout << "wrote " << o.out_path << '\n';
}

}  // namespace

void add_picture(CLI::App& app) {
  auto* command = app.add_subcommand("picture", "draw a map from above with the trajectory on it");
  auto o = std::make_shared<PictureOptions>();
  command->add_option("--map", o->map_path, "PCD file, or map.yaml of an occupancy grid")->required();
  auto* trajectory = command->add_option("--trajectory", o->trajectory_path, "TUM or KITTI file in the map's frame");
  command->add_option("--truth", o->truth_path, "TUM file; colours the trajectory by its error")->needs(trajectory);
  command->add_option("--time-offset", o->association.time_offset_s, "added to the trajectory's stamps, s");
  command->add_option("--out", o->out_path, "PNG to write")->required();
  command->add_option("--title", o->title, "heading")->capture_default_str();
  command->add_option("--colour", o->colour, "of the map: height (above ground, default) or intensity")
      ->transform(CLI::CheckedTransformer(kMapColours, CLI::ignore_case));
  command->add_option("--width", o->width_px, "pixels")->check(CLI::Range(400, 8000))->capture_default_str();
  command->callback([o] { run_picture(*o); });
}

}  // namespace slamd::eval
