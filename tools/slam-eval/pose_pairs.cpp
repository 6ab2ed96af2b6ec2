// Which two poses an RPE compares. Source: evo (Grupp 2017), metrics by frames, by path and by angle.
#include <cmath>
#include <numbers>

#include "tools/slam-eval/metrics.hpp"
#include "tools/slam-eval/trajectory.hpp"

namespace slamd::eval {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

double angle_deg(const Pose& a, const Pose& b) { return a.rotation.angularDistance(b.rotation) * kDegreesPerRadian; }

std::vector<PosePair> chained(const std::vector<std::size_t>& ends) {
  std::vector<PosePair> pairs;
  for (std::size_t k = 1; k < ends.size(); ++k) pairs.emplace_back(ends[k - 1], ends[k]);
  return pairs;
}

std::vector<PosePair> by_frames(std::size_t count, std::size_t delta, bool all_pairs) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i + delta < count; i += all_pairs ? 1 : delta) pairs.emplace_back(i, i + delta);
  return pairs;
}

std::vector<PosePair> by_path_consecutive(const std::vector<Pose>& poses, double delta_m) {
  std::vector<std::size_t> ends;
  double path_m = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i > 0) path_m += (poses[i].translation - poses[i - 1].translation).norm();
    if (path_m < delta_m) continue;
    ends.push_back(i);
    path_m = 0.0;
  }
  return chained(ends);
}

// The path grows with the index, so the best partner moves forward with i and is found by one sweep.
std::vector<PosePair> by_path_all(const std::vector<Pose>& poses, double delta_m, double tolerance_m) {
  std::vector<double> path_m(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    path_m[i] = path_m[i - 1] + (poses[i].translation - poses[i - 1].translation).norm();
  }
  std::vector<PosePair> pairs;
  std::size_t first = 0;  // the first pose at or beyond delta from i
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const auto miss_m = [&](std::size_t j) { return std::abs(path_m[j] - path_m[i] - delta_m); };
    first = std::max(first, i + 1);
    while (first < poses.size() && path_m[first] - path_m[i] < delta_m) ++first;
    std::size_t best = std::min(first, poses.size() - 1);
    if (first > i + 1 && miss_m(first - 1) <= miss_m(best)) best = first - 1;
    while (best > i + 1 && path_m[best - 1] == path_m[best]) --best;
    if (miss_m(best) <= tolerance_m) pairs.emplace_back(i, best);
  }
  return pairs;
}

std::vector<PosePair> by_angle_consecutive(const std::vector<Pose>& poses, double delta_deg) {
  std::vector<std::size_t> ends{0};
  double turned_deg = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    turned_deg += angle_deg(poses[i - 1], poses[i]);
    if (turned_deg < delta_deg) continue;
    ends.push_back(i);
    turned_deg = 0.0;
  }
  return chained(ends);
}

std::vector<PosePair> by_angle_all(const std::vector<Pose>& poses, double delta_deg, double tolerance_deg) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = i + 1; j < poses.size(); ++j) {
      if (std::abs(angle_deg(poses[i], poses[j]) - delta_deg) <= tolerance_deg) pairs.emplace_back(i, j);
    }
  }
  return pairs;
}

}  // namespace

std::vector<PosePair> pose_pairs(const std::vector<Pose>& poses, const RpeOptions& options) {
  const double delta = options.delta;
  if (!(delta > 0.0) || !std::isfinite(delta)) throw InputError("--delta must be positive");
  const double tolerance = delta * options.relative_tolerance;
  switch (options.unit) {
    case DeltaUnit::kFrames:
      if (delta != std::floor(delta) || delta > 1e9) throw InputError("--delta in frames must be a whole number");
      return by_frames(poses.size(), static_cast<std::size_t>(delta), options.all_pairs);
    case DeltaUnit::kMetres:
      return options.all_pairs ? by_path_all(poses, delta, tolerance) : by_path_consecutive(poses, delta);
    case DeltaUnit::kDegrees:
      return options.all_pairs ? by_angle_all(poses, delta, tolerance) : by_angle_consecutive(poses, delta);
  }
  return {};
}

}  // namespace slamd::eval
