#include "tools/slam-eval/tables/paper_pictures.hpp"

#include "tools/plot/grid_picture.hpp"
#include "tools/plot/map_picture.hpp"
#include "tools/plot/pcd_file.hpp"
#include "tools/slam-eval/association.hpp"
#include "tools/slam-eval/tables/before_after.hpp"
#include "tools/slam-eval/tables/drawn_path.hpp"
#include "tools/slam-eval/tables/table_text.hpp"

namespace slamd::eval {
namespace {

namespace fs = std::filesystem;

class Painter {
 public:
  Painter(const RunMakerOptions& options, const DriveName& drive, const fs::path& folder)
      : options_{options}, drive_{drive}, folder_{folder}, truth_{load_trajectory(truth_path(options, drive), TrajectoryFormat::kTum)} {}

  MatchedPoses matched(const Configuration& configuration) const {
    const fs::path file = run_folder(options_, drive_, configuration.name) / configuration.trajectory;
    MatchedPoses poses = associate(truth_, load_trajectory(file, TrajectoryFormat::kTum), {.interpolate = true});
    if (configuration.in_plane) project_to_plane(poses);
    return poses;
  }

  std::string caption(const Configuration& configuration, const Statistics& s) const {
    return drive_.text() + ", " + configuration.label + format(": APE RMSE %.4f m, max %.4f m", s.rmse, s.max);
  }

  void grid(const Configuration& configuration, std::vector<Figure>& figures) const {
    const fs::path yaml = run_folder(options_, drive_, configuration.name) / "map.yaml";
    if (!fs::exists(yaml)) return;
    const DrawnPath drawn = path_by_error(matched(configuration));
    const std::string words = caption(configuration, drawn.ape), file = drive_.text() + "-" + configuration.name + ".png";
    plot::write_grid_picture({plot::load_grid(yaml.string()), drawn.path, "occupancy grid", words, "error [m]"}, (folder_ / file).string());
    figures.push_back({file, words});
  }

  void cloud(const Configuration& configuration, std::vector<Figure>& figures) const {
    const fs::path pcd = run_folder(options_, drive_, configuration.name) / "map.pcd";
    if (!fs::exists(pcd)) return;
    DrawnPath drawn = path_by_error(matched(configuration));
    plot::MapPicture picture;
    picture.points = plot::read_pcd(pcd.string());
    picture.path = std::move(drawn.path);
    picture.title = "3D map";
    picture.subtitle = caption(configuration, drawn.ape);
    picture.value_label = "error [m]";
    const std::string file = drive_.text() + "-map.png";
    plot::write_map_picture(picture, (folder_ / file).string());
    figures.push_back({file, picture.subtitle});
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
