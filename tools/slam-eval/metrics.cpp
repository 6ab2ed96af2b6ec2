#include "tools/slam-eval/metrics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

namespace slamd::eval {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

double angle_rad(const Eigen::Quaterniond& q) { return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w())); }

double rotation_part_squared(const Pose& E) {
  return (E.rotation.toRotationMatrix() - Eigen::Matrix3d::Identity()).squaredNorm();
}

double reduce(const Pose& E, PoseRelation relation) {
  switch (relation) {
    case PoseRelation::kTranslationPart:
    case PoseRelation::kPointDistance: return E.translation.norm();
    case PoseRelation::kRotationAngleDeg: return angle_rad(E.rotation) * kDegreesPerRadian;
    case PoseRelation::kRotationAngleRad: return angle_rad(E.rotation);
    case PoseRelation::kRotationPart: return std::sqrt(rotation_part_squared(E));
    case PoseRelation::kFullTransformation:
      return std::sqrt(rotation_part_squared(E) + E.translation.squaredNorm());
  }
  return 0.0;
}

double median_of_sorted(const std::vector<double>& sorted) {
  const std::size_t middle = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
}

}  // namespace

const char* name(PoseRelation relation) {
  switch (relation) {
    case PoseRelation::kTranslationPart: return "translation_part";
    case PoseRelation::kRotationAngleDeg: return "rotation_angle_deg";
    case PoseRelation::kRotationAngleRad: return "rotation_angle_rad";
    case PoseRelation::kRotationPart: return "rotation_part";
    case PoseRelation::kFullTransformation: return "full_transformation";
    case PoseRelation::kPointDistance: return "point_distance";
  }
  return "";
}

const char* unit(PoseRelation relation) {
  switch (relation) {
    case PoseRelation::kTranslationPart:
    case PoseRelation::kPointDistance: return "m";
    case PoseRelation::kRotationAngleDeg: return "deg";
    case PoseRelation::kRotationAngleRad: return "rad";
    default: return "";
  }
}

Statistics statistics(std::vector<double> errors) {
  if (errors.empty()) return {};
  std::sort(errors.begin(), errors.end());
  Statistics s;
  const double n = static_cast<double>(errors.size());
  s.count = errors.size();
  s.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
  double spread = 0.0;
  for (const double e : errors) {
    s.sse += e * e;
    spread += (e - s.mean) * (e - s.mean);
  }
  s.rmse = std::sqrt(s.sse / n);
  s.std = std::sqrt(spread / n);
  s.median = median_of_sorted(errors);
  s.min = errors.front();
  s.max = errors.back();
  return s;
}

std::vector<double> ape(const std::vector<Pose>& truth, const std::vector<Pose>& estimate, PoseRelation relation) {
  assert(truth.size() == estimate.size());
  std::vector<double> errors;
  errors.reserve(truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) errors.push_back(reduce(estimate[i].inverse() * truth[i], relation));
  return errors;
}

std::vector<double> rpe(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                        const std::vector<PosePair>& pairs, PoseRelation relation) {
  std::vector<double> errors;
  errors.reserve(pairs.size());
  for (const auto& [i, j] : pairs) {
    const Pose truth_step = truth[i].inverse() * truth[j];
    const Pose estimate_step = estimate[i].inverse() * estimate[j];
    errors.push_back(relation == PoseRelation::kPointDistance
                         ? std::abs(truth_step.translation.norm() - estimate_step.translation.norm())
                         : reduce(truth_step.inverse() * estimate_step, relation));
  }
  return errors;
}

}  // namespace slamd::eval
