#include "tools/slam-eval/tables/run_table.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::eval {
namespace {

double median_of_sorted(const std::vector<double>& values) {
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

std::vector<std::string> scenarios_of(const std::vector<Run>& runs) {
  std::vector<std::string> names;
  for (const Run& run : runs) {
    if (std::ranges::find(names, run.drive.scenario) == names.end()) names.push_back(run.drive.scenario);
  }
  return names;
}

Summary summary_of(const std::vector<Run>& runs, const std::string& scenario, const std::string& configuration,
                   const std::string& reference) {
  std::vector<double> ape, rpe, ape_ratio, rpe_ratio, closures;
  Summary summary{.scenario = scenario, .configuration = configuration};
  for (const Run& run : runs) {
    if (run.drive.scenario != scenario || run.configuration != configuration) continue;
    summary.driven_m += run.driven_m;
    ape.push_back(run.ape.rmse);
    rpe.push_back(run.rpe.rmse);
    closures.push_back(static_cast<double>(run.closures));
    const Run* before = find(runs, run.drive.text(), reference);
    if (before == nullptr || before->ape.rmse <= 0.0 || before->rpe.rmse <= 0.0) continue;
    ape_ratio.push_back(run.ape.rmse / before->ape.rmse);
    rpe_ratio.push_back(run.rpe.rmse / before->rpe.rmse);
  }
  summary.runs = ape.size();
  if (summary.runs > 0) summary.driven_m /= static_cast<double>(summary.runs);
  summary.ape_m = spread(ape);
  summary.rpe_m = spread(rpe);
  summary.ape_ratio = spread(ape_ratio);
  summary.rpe_ratio = spread(rpe_ratio);
  summary.closures = spread(closures);
  return summary;
}

}  // namespace

std::string DriveName::text() const {
  std::string name = scenario + "-" + std::to_string(seed);
  if (length_m > 0.0) name += "-" + std::to_string(std::lround(length_m)) + "m";
  for (const std::string& part : {lidar, variant}) {
    if (!part.empty()) name += "-" + part;
  }
  return name;
}

const Run* find(const std::vector<Run>& runs, const std::string& drive, const std::string& configuration) {
  const auto found = std::ranges::find_if(
      runs, [&](const Run& run) { return run.drive.text() == drive && run.configuration == configuration; });
  return found == runs.end() ? nullptr : &*found;
}

Spread spread(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  return {values.front(), median_of_sorted(values), values.back()};
}

std::vector<Summary> summarise(const std::vector<Run>& runs, const std::vector<Configuration>& configurations) {
  std::vector<Summary> summaries;
  for (const std::string& scenario : scenarios_of(runs)) {
    for (const Configuration& configuration : configurations) {
      summaries.push_back(summary_of(runs, scenario, configuration.name, configurations.front().name));
    }
  }
  return summaries;
}

}  // namespace slamd::eval
