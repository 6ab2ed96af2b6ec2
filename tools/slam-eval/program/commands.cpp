#include "tools/slam-eval/program/commands.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <map>
#include <memory>

#include "tools/slam-eval/program/error_plot.hpp"
#include "tools/slam-eval/program/report.hpp"

namespace slamd::eval {
namespace {

const std::map<std::string, PoseRelation> kRelations{
    {"trans_part", PoseRelation::kTranslationPart}, {"angle_deg", PoseRelation::kRotationAngleDeg},
    {"angle_rad", PoseRelation::kRotationAngleRad}, {"rot_part", PoseRelation::kRotationPart},
    {"full", PoseRelation::kFullTransformation},    {"point_distance", PoseRelation::kPointDistance}};

const std::map<std::string, DeltaUnit> kUnits{
    {"f", DeltaUnit::kFrames}, {"m", DeltaUnit::kMetres}, {"deg", DeltaUnit::kDegrees}};

void add_input_options(CLI::App& command, CommonOptions& o) {
  command.add_option("TRUTH", o.truth_path, "reference trajectory")->required();
  command.add_option("EST", o.estimate_path, "estimated trajectory")->required();
  command.add_option("--format", o.format, "tum, kitti, or auto (by the number of columns)")
      ->check(CLI::IsMember({"auto", "tum", "kitti"}))
      ->capture_default_str();
  command.add_option("--max-diff,--t_max_diff", o.association.max_diff_s, "largest difference of matched stamps, s")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_option("--time-offset,--t_offset", o.association.time_offset_s, "added to the estimate's stamps, s");
  command.add_flag("--interpolate", o.association.interpolate,
                   "compare with the truth interpolated to the estimate's stamps");
  command.add_flag("--in-plane", o.in_plane, "compare x, y and heading alone, as a planar estimate has them");
  command
      .add_option_function<std::vector<std::string>>(
          "-r,--relation",
          [&o](const std::vector<std::string>& words) {
            o.relations.clear();
            for (const auto& word : words) o.relations.push_back(kRelations.at(word));
          },
          "pose relations (default: trans_part angle_deg full)")
      ->check(CLI::IsMember(kRelations));
  command.add_option("--json", o.json_path, "write the numbers to this file");
  command.add_option("--plot", o.plot_path, "write a PNG: trajectory by error, error over time (of the first relation)");
}

// `chosen` is what stands without any of the flags.
void add_alignment_options(CLI::App& command, CommonOptions& o, Alignment chosen) {
  o.alignment = chosen;
  const auto flag = [&](const std::string& names, Alignment alignment, const std::string& text) {
    return command.add_flag_callback(
        names, [&o, alignment] { o.alignment = alignment; }, text);
  };
  const std::string note = " (default)";
  const bool aligned = chosen == Alignment::kSe3Umeyama;
  auto* none = flag("--no-align", Alignment::kNone, "compare as they are" + (aligned ? "" : note));
  auto* se3 = flag("-a,--align", Alignment::kSe3Umeyama, "SE(3) Umeyama, no scale" + (aligned ? note : ""));
  auto* sim3 = flag("-s,--scale,--correct_scale", Alignment::kSim3Umeyama, "Umeyama with scale");
  auto* origin = flag("--align-origin,--align_origin", Alignment::kOrigin, "first pose onto first pose");
  none->excludes(se3)->excludes(sim3)->excludes(origin);
  origin->excludes(se3)->excludes(sim3);
  command.add_option("--n-to-align,--n_to_align", o.align_count, "fit over the first N poses only (0 = all)");
}

Trajectory load(const std::string& path, const std::string& format) {
  if (format == "auto") return load_trajectory(path, guess_format(path));
  return load_trajectory(path, format == "kitti" ? TrajectoryFormat::kKitti : TrajectoryFormat::kTum);
}

MatchedPoses load_aligned(const CommonOptions& o) {
  const Trajectory truth = load(o.truth_path, o.format);
  const Trajectory estimate = load(o.estimate_path, o.format);
  MatchedPoses matched = associate(truth, estimate, o.association);
  if (o.in_plane) project_to_plane(matched);
  matched.estimate = aligned(fit(o.alignment, matched.truth, matched.estimate, o.align_count), matched.estimate);
  return matched;
}

Report describe(const std::string& metric, const CommonOptions& o, const MatchedPoses& matched) {
  Report report;
  report.metric = metric;
  report.truth_path = o.truth_path;
  report.estimate_path = o.estimate_path;
  report.alignment = name(o.alignment);
  report.matched_poses = matched.truth.size();
  return report;
}

void deliver(const Report& report, const CommonOptions& o) {
  std::cout << table(report);
  if (!o.json_path.empty()) write_json(report, o.json_path);
}

void run_ape(const CommonOptions& o) {
  const MatchedPoses matched = load_aligned(o);
  Report report = describe("ape", o, matched);
  for (const PoseRelation relation : o.relations) {
    report.rows.push_back({relation, statistics(ape(matched.truth, matched.estimate, relation))});
  }
  deliver(report, o);
  if (o.plot_path.empty()) return;
  const auto errors = ape(matched.truth, matched.estimate, o.relations.front());
  write_error_plot({report.rows.front(), "APE", errors, matched.estimate, matched.stamps_s, matched.truth}, o.plot_path);
}

// The error of a pair is drawn where the pair ends.
ErrorPlot rpe_plot(const MatchedPoses& matched, const std::vector<PosePair>& pairs, const ReportRow& row) {
  ErrorPlot plot{row, "RPE", rpe(matched.truth, matched.estimate, pairs, row.relation), {}, {}, matched.truth};
  for (const auto& [begin, end] : pairs) {
    plot.poses.push_back(matched.estimate[end]);
    if (!matched.stamps_s.empty()) plot.stamps_s.push_back(matched.stamps_s[end]);
  }
  return plot;
}

void run_rpe(const CommonOptions& o, const RpeOptions& rpe_options) {
  const MatchedPoses matched = load_aligned(o);
  const auto pairs = pose_pairs(rpe_options.pairs_from_truth ? matched.truth : matched.estimate, rpe_options);
  if (pairs.empty()) {
    throw InputError("no two of the " + std::to_string(matched.truth.size()) +
                     " matched poses are --delta apart: the drive is too short, take a smaller --delta");
  }
  Report report = describe("rpe", o, matched);
  report.rpe = rpe_options;
  for (const PoseRelation relation : o.relations) {
    report.rows.push_back({relation, statistics(rpe(matched.truth, matched.estimate, pairs, relation))});
  }
  deliver(report, o);
  if (!o.plot_path.empty()) write_error_plot(rpe_plot(matched, pairs, report.rows.front()), o.plot_path);
}

}  // namespace

void add_ape(CLI::App& app) {
  auto* command = app.add_subcommand("ape", "absolute pose error of EST against TRUTH");
  auto options = std::make_shared<CommonOptions>();
  add_input_options(*command, *options);
  add_alignment_options(*command, *options, Alignment::kSe3Umeyama);
  command->callback([options] { run_ape(*options); });
}

void add_rpe(CLI::App& app) {
  auto* command = app.add_subcommand("rpe", "relative pose error of EST against TRUTH over a distance");
  auto options = std::make_shared<CommonOptions>();
  auto rpe_options = std::make_shared<RpeOptions>();
  add_input_options(*command, *options);
  add_alignment_options(*command, *options, Alignment::kNone);
  command->add_option("-d,--delta", rpe_options->delta, "distance of a pair, in --unit")->capture_default_str();
  command->add_option("-u,--unit,--delta_unit", rpe_options->unit, "f (frames, default), m (metres) or deg (degrees)")
      ->transform(CLI::CheckedTransformer(kUnits, CLI::ignore_case));
  command->add_flag("--all-pairs,--all_pairs", rpe_options->all_pairs, "a pair from every pose, not one after the other");
  command->add_option("--delta-tol,--delta_tol,-t", rpe_options->relative_tolerance,
                      "with --all-pairs in m or deg: share of delta that a pair may be off")
      ->capture_default_str();
  command->add_flag("--pairs-from-truth,--pairs_from_reference", rpe_options->pairs_from_truth,
                    "measure --delta along the truth, not the estimate");
  command->callback([options, rpe_options] { run_rpe(*options, *rpe_options); });
}

}  // namespace slamd::eval
