#include "estimator/graph/place_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace slamd {

namespace {

constexpr double kSureDistance_m = 0.7;   // registration finds home from here by itself
constexpr double kSureYaw_rad = 2.0 * std::numbers::pi / 180.0;
constexpr PlanarWindow kLookAlikeWindow{.distance_m = 15.0, .yaw_rad = 0.16};

Pose spatial(const TurnAndShift& T, double height_m) {
  return {Eigen::Quaterniond{Eigen::AngleAxisd{T.yaw_rad, Eigen::Vector3d::UnitZ()}}, {T.x_m, T.y_m, height_m}};
}

/// A better first guess where the window is wide. None: nothing fits, or several places fit equally well.
std::optional<Pose> first_guess(const Submap& target, const Submap& source, const PlaceGuess& guess,
                                const LoopCloserConfig& config) {
  const bool sure = guess.window.distance_m < kSureDistance_m && guess.window.yaw_rad < kSureYaw_rad;
  if (sure) return spatial(guess.T_target_source, guess.height_m);
  const PlanarMatch found = search(BirdView{target}, BirdView{source}, guess.T_target_source, guess.window);
  const bool wide = guess.window.distance_m > 2.0 * PlanarMatch::kApart_m;
  if (found.score < config.min_search_score || (wide && found.runner_up > config.max_runner_up * found.score)) return {};
  return spatial(found.T_target_source, found.height_m);
}

}  // namespace

PlaceGuess guess_of(const PlaceMatch& match) {
  return {.T_target_source = {.x_m = 0.0, .y_m = 0.0, .yaw_rad = match.yaw_rad}, .window = kLookAlikeWindow};
}

TurnAndShift planar(const Pose& T) {
  const Eigen::Vector3d ahead = T.rotation * Eigen::Vector3d::UnitX();
  return {T.translation.x(), T.translation.y(), std::atan2(ahead.y(), ahead.x())};
}

PlaceCheck check_place(const Submap& target, const Submap& source, const PlaceGuess& guess, const LoopCloserConfig& config) {
  PlaceCheck check;
  const auto ends = [&check](LoopStage stage) {
    check.ended_at = stage;
    return check;
  };
  const std::optional<Pose> first = first_guess(target, source, guess, config);
  if (!first) return ends(LoopStage::kSearch);

  SubmapShape target_shape = shape_of(target.points, config.registration.max_points);
  SubmapShape source_shape = shape_of(source.points, config.registration.max_points);
  const SubmapMatch match = register_submap(target_shape, source_shape, *first, config.registration);
  check.fitness = match.inlier_share;
  check.registered = true;
  check.T_target_source = match.T_target_source;
  if (!match.converged || match.inlier_share < config.min_fitness) return ends(LoopStage::kRegistration);
  check.overlap = match.overlap;
  if (match.overlap < config.min_overlap) return ends(LoopStage::kOverlap);

  const Pose& T_target_source = match.T_target_source.T_a_b;
  check.free_space_share =
      std::max(check_free_space(target_shape.planes, source, T_target_source, config.free_space).share(),
               check_free_space(source_shape.planes, target, T_target_source.inverse(), config.free_space).share());
  if (check.free_space_share > config.max_free_space_share) return ends(LoopStage::kFreeSpace);
  return ends(LoopStage::kAccepted);
}

}  // namespace slamd
