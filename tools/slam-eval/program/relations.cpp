// slam-eval relations: the error of a trajectory by pairs of instants whose relative pose is known.

#include "tools/slam-eval/relations.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tools/slam-eval/program/commands.hpp"

namespace slamd::eval {
namespace {

constexpr double kDeg = 180.0 / std::numbers::pi;

struct RelationsOptions {
  std::string relations_path;
  std::string estimate_path;
  std::string json_path;
  double max_diff_s = 0.006;
};

void run_relations(const RelationsOptions& o) {
  const Trajectory estimate = load_trajectory(o.estimate_path, TrajectoryFormat::kTum);
  const RelationErrors errors = errors_by_relations(load_relations(o.relations_path), estimate, o.max_diff_s);
  const Statistics translation = statistics(errors.translation_m), angle = statistics(errors.angle_rad);
  std::printf("%zu relations, %zu without a pose within %g s\n", translation.count, errors.without_pose, o.max_diff_s);
  std::printf("translation m   mean %.4f +- %.4f  median %.4f  max %.4f\n", translation.mean, translation.std, translation.median, translation.max);
  std::printf("rotation deg    mean %.3f +- %.3f  median %.3f  max %.3f\n", kDeg * angle.mean, kDeg * angle.std, kDeg * angle.median, kDeg * angle.max);
  if (translation.count == 0) throw InputError("no relation has a pose at both ends: other stamps, or --max-diff is too small");
  if (o.json_path.empty()) return;
  const nlohmann::ordered_json json{{"relations", translation.count},
                                    {"without_pose", errors.without_pose},
                                    {"translation_m", {{"mean", translation.mean}, {"std", translation.std}, {"median", translation.median}, {"max", translation.max}}},
                                    {"rotation_deg", {{"mean", kDeg * angle.mean}, {"std", kDeg * angle.std}, {"median", kDeg * angle.median}, {"max", kDeg * angle.max}}}};
  std::ofstream out{o.json_path};
  out << json.dump(2) << '\n';
  if (!out.flush()) throw InputError(o.json_path + ": cannot be written");
}

}  // namespace

void add_relations(CLI::App& app) {
  auto* command = app.add_subcommand("relations", "error of EST by relative poses of pairs of instants (Kuemmerle 2009)");
  auto o = std::make_shared<RelationsOptions>();
  command->add_option("RELATIONS", o->relations_path, "lines: from_s to_s x y z roll pitch yaw")->required();
  command->add_option("EST", o->estimate_path, "TUM file")->required();
  command->add_option("--max-diff", o->max_diff_s, "largest difference of a stamp to its pose's, s")->check(CLI::NonNegativeNumber)->capture_default_str();
  command->add_option("--json", o->json_path, "write the numbers to this file");
  command->callback([o] { run_relations(*o); });
}

}  // namespace slamd::eval
