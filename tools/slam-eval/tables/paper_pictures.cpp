#include "tools/slam-eval/tables/paper_pictures.hpp"

#include "tools/plot/grid_picture.hpp"
#include "tools/plot/map_picture.hpp"
#include "tools/plot/pcd_file.hpp"
#include "tools/slam-eval/alignment.hpp"
#include "tools/slam-eval/association.hpp"
#include "tools/slam-eval/tables/before_after.hpp"
#include "tools/slam-eval/tables/table_text.hpp"

namespace slamd::eval {
namespace {

namespace fs = std::filesystem;

/// A run's trajectory in its own map, and its errors.
struct DrawnPath {
  plot::ColouredPath path;
  std::string subtitle;
};

class Painter {
 public:
  Painter(const RunMakerOptions& options, const DriveName& drive, const fs::path& folder)
      : options_{options}, drive_{drive}, folder_{folder}, truth_{load_trajectory(truth_path(options, drive), TrajectoryFormat::kTum)} {}

  MatchedPoses matched(const Configuration& configuration) const {
    const fs::path file = run_folder(options_, drive_, configuration.name) / configuration.trajectory;
    return associate(truth_, load_trajectory(file, TrajectoryFormat::kTum), {.interpolate = true});
  }

  DrawnPath path_of(const Configuration& configuration) const {
    const MatchedPoses poses = matched(configuration);
    const std::vector<Pose> over = aligned(fit(Alignment::kSe3Umeyama, poses.estimate, poses.truth), poses.truth);
    DrawnPath drawn;
    drawn.path.values = ape(over, poses.estimate, PoseRelation::kTranslationPart);
    drawn.path.range = plot::colour_range(drawn.path.values);
    for (const Pose& pose : poses.estimate) drawn.path.points.push_back({pose.translation.x(), pose.translation.y()});
    const Statistics s = statistics(drawn.path.values);
    drawn.subtitle = drive_.text() + ", " + configuration.label + format(": APE RMSE %.4f m, max %.4f m", s.rmse, s.max);
    return drawn;
  }

  void grid(const Configuration& configuration, std::vector<Figure>& figures) const {
    const fs::path yaml = run_folder(options_, drive_, configuration.name) / "map.yaml";
    if (!fs::exists(yaml)) return;
    const DrawnPath drawn = path_of(configuration);
    const std::string file = drive_.text() + "-" + configuration.name + ".png";
    plot::write_grid_picture({plot::load_grid(yaml.string()), drawn.path, "occupancy grid", drawn.subtitle, "error [m]"},
                             (folder_ / file).string());
    figures.push_back({file, drawn.subtitle});
  }

  void cloud(const Configuration& configuration, std::vector<Figure>& figures) const {
    const fs::path pcd = run_folder(options_, drive_, configuration.name) / "map.pcd";
    if (!fs::exists(pcd)) return;
    DrawnPath drawn = path_of(configuration);
    plot::MapPicture picture;
    picture.points = plot::load_pcd(pcd.string());
    picture.path = std::move(drawn.path);
    picture.title = "3D map";
    picture.subtitle = drawn.subtitle;
    picture.value_label = "error [m]";
    const std::string file = drive_.text() + "-map.png";
    plot::write_map_picture(picture, (folder_ / file).string());
    figures.push_back({file, drawn.subtitle});
  }

  void before_after(const Configuration& before, const Configuration& after, std::vector<Figure>& figures) const {
    const std::string file = drive_.text() + "-before-after.png";
    write_before_after(drive_.text(), {{before.label, matched(before)}, {after.label, matched(after)}}, (folder_ / file).string());
    figures.push_back({file, drive_.text() + ": before and after the pose graph"});
  }

 private:
  const RunMakerOptions& options_;
  const DriveName& drive_;
  const fs::path& folder_;
  Trajectory truth_;
};

}  // namespace

std::vector<Figure> draw_figures(const RunMakerOptions& options, const std::vector<Plan>& plans, const fs::path& folder) {
  std::vector<Figure> figures;
  for (const Plan& plan : plans) {
    const Painter painter{options, plan.drive, folder};
    std::vector<const Configuration*> spatial;
    for (const Configuration& configuration : plan.configurations) {
      painter.grid(configuration, figures);
      painter.cloud(configuration, figures);
      if (!fs::exists(run_folder(options, plan.drive, configuration.name) / "map.yaml")) spatial.push_back(&configuration);
    }
    if (spatial.size() > 1) painter.before_after(*spatial.front(), *spatial.back(), figures);
  }
  return figures;
}

std::string figures_markdown(const std::vector<Figure>& figures) {
  std::string out = "## Figures\n\n";
  for (const Figure& figure : figures) out += figure.caption + "\n\n![" + figure.caption + "](" + figure.file + ")\n\n";
  return out;
}

}  // namespace slamd::eval
