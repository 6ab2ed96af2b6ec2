// slam-eval picture: a map from above with the trajectory on it, coloured by error when there is a truth.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>

#include "tools/plot/map_picture.hpp"
#include "tools/plot/pcd_file.hpp"
#include "tools/slam-eval/program/commands.hpp"

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

void add_plain_path(const Trajectory& trajectory, plot::MapPicture& picture) {
  for (const Pose& pose : trajectory.poses) picture.path.points.push_back(top_down(pose));
}

// The truth is laid over the estimate, because the map is in the estimate's frame; errors are those of an aligned APE.
void add_path_with_errors(const Trajectory& trajectory, const PictureOptions& o, plot::MapPicture& picture) {
  const Trajectory truth = load_trajectory(o.truth_path, guess_format(o.truth_path));
  const MatchedPoses matched = associate(truth, trajectory, o.association);
  const Similarity over_estimate = fit(Alignment::kSe3Umeyama, matched.estimate, matched.truth);
  const std::vector<Pose> truth_in_odom = aligned(over_estimate, matched.truth);
  picture.path.values = ape(truth_in_odom, matched.estimate, PoseRelation::kTranslationPart);
  picture.path.range = plot::colour_range(picture.path.values);
  picture.value_label = "error [m]";
  for (const Pose& pose : matched.estimate) picture.path.points.push_back(top_down(pose));
  for (const Pose& pose : truth_in_odom) picture.truth.push_back(top_down(pose));
  const Statistics s = statistics(picture.path.values);
  picture.subtitle += text("  ·  APE RMSE %.3f m, worst %.3f m", s.rmse, s.max);
}

void run_picture(const PictureOptions& o) {
  plot::MapPicture picture;
  picture.points = plot::read_pcd(o.map_path);
  picture.colour = o.colour;
  picture.title = o.title;
  picture.width_px = o.width_px;
  picture.subtitle = point_count(picture.points.size());
  if (!o.trajectory_path.empty()) {
    const Trajectory trajectory = load_trajectory(o.trajectory_path, guess_format(o.trajectory_path));
    picture.subtitle = text("%.0f m driven  ·  ", length_m(trajectory.poses)) + picture.subtitle;
    if (o.truth_path.empty()) {
      add_plain_path(trajectory, picture);
    } else {
      add_path_with_errors(trajectory, o, picture);
    }
  }
  plot::write_map_picture(picture, o.out_path);
  std::cout << "wrote " << o.out_path << '\n';
}

}  // namespace

void add_picture(CLI::App& app) {
  auto* command = app.add_subcommand("picture", "draw a map from above with the trajectory on it");
  auto o = std::make_shared<PictureOptions>();
  command->add_option("--map", o->map_path, "PCD file")->required();
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
