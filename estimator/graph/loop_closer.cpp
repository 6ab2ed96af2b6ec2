#include "estimator/graph/loop_closer.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace slamd {

namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kSigmas = 3.0;
constexpr double kDoubtfulWeight = 0.1;
constexpr std::uint32_t kDoubtsToRetract = 2;
constexpr std::size_t kPreselected = 12;
constexpr std::size_t kLooksTried = 3;      // places verified in one attempt to recognise one

/// The larger of the two horizontal sigmas.
double horizontal_sigma_m(const Matrix6d& covariance) {
  const Eigen::Matrix2d xy = covariance.topLeftCorner<2, 2>();
  return std::sqrt(std::max(0.0, xy.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff()));
}

/// Of the keyframes in the middle of the sub-maps: a match says where sub-maps lie, and a keyframe at the edge of one is
/// tied to it by all the odometry in between.
LoopClosure closure_of(const Submap& target, const Submap& source, const RelativePose& T_target_source) {
  const RelativePose T_from_to = RelativePose{target.T_level_middle.inverse()} * T_target_source *
                                 RelativePose{source.T_level_middle};
  return {target.middle, source.middle, T_from_to.T_a_b, T_from_to.covariance};
}

}  // namespace

LoopCloser::LoopCloser(const LoopCloserConfig& config, const Eigen::Vector3d& p_base_lidar)
    : config_{config}, clouds_{config.clouds, p_base_lidar} {}

void LoopCloser::add(const Keyframe& keyframe) {
  append(keyframe);
  clouds_.add(keyframe.points);
}

void LoopCloser::restore(const Keyframe& keyframe, std::vector<std::uint8_t> packed) {
  append(keyframe);
  if (!is_packed_cloud(packed)) packed.clear();
  clouds_.add_packed(std::move(packed));
  restored_ = next_ = clouds_.size();
}

void LoopCloser::restore(const GraphView& view, std::span<const LoopClosure> closures) {
  for (const LoopClosure& closure : closures) {
    LoopCandidateReport report = candidate(view, closure.from, closure.to).report;
    report.T_from_to = closure.T_from_to;
    take_in(view, closure, report);
  }
  collect();
}

void LoopCloser::append(const Keyframe& keyframe) {
  const Eigen::Vector3d& position = keyframe.state.T_odom_base.translation;
  driven_m_.push_back(driven_m_.empty() ? 0.0 : driven_m_.back() + (position - last_position_).norm());
  last_position_ = position;
  pieces_.push_back(keyframe.state.odom_piece);
}

std::size_t LoopCloser::bytes() const {
  const std::size_t a_keyframe = sizeof(double) + sizeof(std::vector<std::uint8_t>);
  const std::size_t agreements = passed_.size() * passed_.size() / 8;
  return clouds_.size() * a_keyframe + places_.size() * (sizeof(std::size_t) + sizeof(PlaceDescriptor)) +
         passed_.size() * (sizeof(Passed) + sizeof(LoopClosure)) + agreements + reports_.size() * sizeof(LoopCandidateReport);
}

bool LoopCloser::update(const GraphView& view, const Cancelled& cancelled) {
  describe_restored(view);
  const std::vector<std::size_t> before = believed_;
  const std::size_t size = std::min({clouds_.size(), view.keyframes.size(), view.odometry.size()});
  while (next_ + config_.keyframes_ahead < size) {
    look_from(view, next_);
    next_ += config_.search_every;
    if (cancelled && cancelled()) break;
  }
  collect();
  return believed_ != before;
}

void LoopCloser::look_from(const GraphView& view, std::size_t to) {
  std::vector<Candidate> candidates = near_candidates(view, to);
  for (Candidate& candidate : candidates) {
    if (verify(view, candidate) != LoopStage::kAccepted) reports_.push_back(candidate.report);
  }
  describe_place(view, to);
}

/// Late, since it takes longer than to find a vehicle that stands where it stood.
void LoopCloser::describe_restored(const GraphView& view) {
  for (std::size_t i = 0; i < restored_; i += config_.search_every) describe_place(view, i);
  restored_ = 0;
}

void LoopCloser::describe_place(const GraphView& view, std::size_t keyframe) {
  places_.push_back(keyframe);
  descriptors_.push_back(
      describe(clouds_.submap(view.odometry, keyframe, config_.keyframes_behind, config_.keyframes_ahead)));
}

/// Earlier keyframes within the radius of where we may be: the nearest one, or those that look alike when the radius has
/// grown so far that the nearest means little.
std::vector<LoopCloser::Candidate> LoopCloser::near_candidates(const GraphView& view, std::size_t to) const {
  const Eigen::Vector3d& p_map = view.keyframes[to].T_map_base.translation;
  std::size_t nearest = to;
  double nearest_m = std::numeric_limits<double>::infinity();
  double radius_m = config_.radius_m;
  for (std::size_t from = 0; from + config_.min_keyframes_back <= to; ++from) {
    const double distance_m = (view.keyframes[from].T_map_base.translation - p_map).norm();
    if (distance_m >= nearest_m || !is_loop(view, from, to)) continue;
    nearest = from;
    nearest_m = distance_m;
  }
  if (nearest == to) return {};
  const double drift_sigma_m = horizontal_sigma_m(view.odometry.relative_covariance(nearest, to));
  if (drift_sigma_m < config_.max_held_sigma_m && is_held_by_odometry(view, nearest, to)) return {};
  radius_m += kSigmas * drift_sigma_m;
  if (radius_m > 2.0 * config_.radius_m) return look_alikes(view, to, radius_m);
  if (nearest_m > radius_m) return {};
  return {candidate(view, nearest, to)};
}

std::vector<LoopCloser::Candidate> LoopCloser::look_alikes(const GraphView& view, std::size_t to,
                                                           double radius_m) const {
  const Eigen::Vector3d& p_map = view.keyframes[to].T_map_base.translation;
  const PlaceDescriptor here =
      describe(clouds_.submap(view.odometry, to, config_.keyframes_behind, config_.keyframes_ahead));
  const std::vector<PlaceMatch> matches = ranked_places(here, [&](std::size_t from) {
    const bool in_reach = (view.keyframes[from].T_map_base.translation - p_map).norm() < radius_m;
    return from + config_.min_keyframes_back <= to && in_reach && is_loop(view, from, to);
  });
  std::vector<Candidate> candidates;
  for (const PlaceMatch& m : matches) {
    if (candidates.size() == config_.candidates_by_appearance || m.distance > config_.max_descriptor_distance) break;
    candidates.push_back(look_alike(view, places_[m.place], to, m));
  }
  return candidates;
}

/// Of the eligible keyframes with a descriptor those that look most like it, the best first.
template <class Eligible>
std::vector<PlaceMatch> LoopCloser::ranked_places(const PlaceDescriptor& here, Eligible&& eligible) const {
  std::vector<PlaceMatch> matches;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (eligible(places_[i])) matches.push_back({.place = i, .distance = ring_key_distance(descriptors_[i], here)});
  }
  const auto closer = [](const PlaceMatch& a, const PlaceMatch& b) { return a.distance < b.distance; };
  std::ranges::stable_sort(matches, closer);
  matches.resize(std::min(matches.size(), kPreselected));
  for (PlaceMatch& m : matches) {
    const std::size_t place = m.place;
    m = match(descriptors_[place], here);
    m.place = place;
  }
  std::ranges::stable_sort(matches, closer);
  return matches;
}

LoopCloser::Candidate LoopCloser::look_alike(const GraphView& view, std::size_t from, std::size_t to,
                                             const PlaceMatch& match) const {
  Candidate found = candidate(view, from, to);
  found.guess = guess_of(match);
  found.report.by_appearance = true;
  found.report.descriptor_distance = match.distance;
  return found;
}

/// The vehicle went away and came back.
bool LoopCloser::is_loop(const GraphView& view, std::size_t from, std::size_t to) const {
  const double straight_m = (view.odometry.T_odom_base(from).translation - view.odometry.T_odom_base(to).translation).norm();
  return driven_m_[to] - driven_m_[from] > 3.0 * straight_m + config_.min_detour_m;
}

/// The odometry's own map has not forgotten the place in between.
bool LoopCloser::is_held_by_odometry(const GraphView& view, std::size_t from, std::size_t to) const {
  if (pieces_[from] != pieces_[to]) return false;
  const Eigen::Vector3d& p_odom = view.odometry.T_odom_base(from).translation;
  for (std::size_t i = from + 1; i < to; ++i) {
    const Eigen::Vector3d away = view.odometry.T_odom_base(i).translation - p_odom;
    if (away.cwiseAbs().maxCoeff() > config_.local_map_reach_m) return false;
  }
  return true;
}

LoopCloser::Candidate LoopCloser::candidate(const GraphView& view, std::size_t from, std::size_t to) const {
  const Pose& T_map_from = view.keyframes[from].T_map_base;
  const Pose& T_map_to = view.keyframes[to].T_map_base;
  const Pose T_from_to = level(T_map_from).inverse() * level(T_map_to);
  const Matrix6d covariance = view.odometry.relative_covariance(from, to);
  Candidate result;
  result.from = from;
  result.to = to;
  result.guess = {.T_target_source = planar(T_from_to),
                  .height_m = T_from_to.translation.z(),
                  .window = {.distance_m = kSigmas * horizontal_sigma_m(covariance),
                             .yaw_rad = kSigmas * std::sqrt(std::max(0.0, covariance(5, 5)))}};
  result.report = {.from = from,
                   .to = to,
                   .distance_m = T_from_to.translation.norm(),
                   .descriptor_distance = kNoNumber,
                   .fitness = kNoNumber,
                   .overlap = kNoNumber,
                   .free_space_share = kNoNumber,
                   .odometry_chi2 = kNoNumber,
                   .consistency_chi2 = kNoNumber,
                   .graph_weight = kNoNumber,
                   .T_from_to = T_map_from.inverse() * T_map_to};
  return result;
}

std::optional<Recognition> LoopCloser::recognise(const GraphView& view, const PieceView& piece,
                                                 const std::optional<PlaceBelief>& belief) {
  const std::size_t newest = piece.odometry.size() - 1;
  const Submap here = piece.clouds.submap(piece.odometry, newest, config_.keyframes_behind, 0);
  const auto check = [&](std::size_t place, const PlaceGuess& guess) -> std::optional<Recognition> {
    const std::uint32_t around = config_.keyframes_behind;
    const Submap there = clouds_.submap(view.odometry, place, around, around);
    const PlaceCheck found = check_place(there, here, guess, config_);
    if (found.ended_at != LoopStage::kAccepted) return std::nullopt;
    const RelativePose T_place_newest =
        RelativePose{there.T_level_base.inverse()} * found.T_target_source * RelativePose{here.T_level_base};
    return Recognition{place, newest, T_place_newest, !belief};
  };
  if (belief) {
    const std::optional<std::size_t> nearest = nearest_place(view, *belief);
    if (!nearest) return std::nullopt;
    const Pose T_place_guess = level(view.keyframes[*nearest].T_map_base).inverse() * level(belief->T_map_base);
    return check(*nearest, {.T_target_source = planar(T_place_guess), .window = belief->window});
  }
  describe_restored(view);
  const std::vector<PlaceMatch> matches = ranked_places(describe(here), [](std::size_t) { return true; });
  for (const PlaceMatch& m : std::span{matches}.first(std::min(matches.size(), kLooksTried))) {
    if (m.distance > config_.max_descriptor_distance) break;
    if (const std::optional<Recognition> found = check(places_[m.place], guess_of(m))) return found;
  }
  return std::nullopt;
}

/// The keyframe nearest to where it is believed to be, if it may be there.
std::optional<std::size_t> LoopCloser::nearest_place(const GraphView& view, const PlaceBelief& belief) const {
  std::optional<std::size_t> nearest;
  double nearest_m = belief.reach_m;
  for (std::size_t i = clouds_.forgotten(); i < std::min(clouds_.size(), view.keyframes.size()); ++i) {
    const double distance_m = (view.keyframes[i].T_map_base.translation - belief.T_map_base.translation).norm();
    if (distance_m >= nearest_m) continue;
    nearest = i;
    nearest_m = distance_m;
  }
  return nearest;
}

LoopStage LoopCloser::try_pair(const GraphView& view, std::uint64_t from, std::uint64_t to, Guess guess) {
  Candidate pair = candidate(view, from, to);
  if (guess == Guess::kSamePlace) {
    const auto description = [&](std::size_t place) {
      return describe(clouds_.submap(view.odometry, place, config_.keyframes_behind, config_.keyframes_ahead));
    };
    pair = look_alike(view, from, to, match(description(from), description(to)));
  }
  const LoopStage stage = verify(view, pair);
  if (stage != LoopStage::kAccepted) reports_.push_back(pair.report);
  collect();
  return stage;
}

LoopStage LoopCloser::verify(const GraphView& view, Candidate& candidate) {
  LoopCandidateReport& report = candidate.report;
  const auto ends = [&](LoopStage stage) { return report.ended_at = stage; };
  const std::uint32_t behind = config_.keyframes_behind;
  const Submap target = clouds_.submap(view.odometry, candidate.from, behind, behind);
  const Submap source = clouds_.submap(view.odometry, candidate.to, behind, config_.keyframes_ahead);
  const PlaceCheck check = check_place(target, source, candidate.guess, config_);
  report.fitness = check.fitness;
  report.overlap = check.overlap;
  report.free_space_share = check.free_space_share;
  if (check.registered) {
    report.T_from_to = target.T_level_base.inverse() * check.T_target_source.T_a_b * source.T_level_base;
  }
  if (check.ended_at != LoopStage::kAccepted) return ends(check.ended_at);

  const LoopClosure closure = closure_of(target, source, check.T_target_source);
  report.odometry_chi2 = odometry_distance2(view.odometry, closure);
  if (report.odometry_chi2 > config_.max_chi2) return ends(LoopStage::kOdometry);
  report.ended_at = LoopStage::kAccepted;
  take_in(view, closure, report);
  return LoopStage::kAccepted;
}

void LoopCloser::take_in(const GraphView& view, const LoopClosure& closure, LoopCandidateReport report) {
  std::vector<std::size_t> agrees_with;
  report.consistency_chi2 = passed_.empty() ? kNoNumber : 0.0;
  for (std::size_t i = 0; i < passed_.size(); ++i) {
    const double chi2 = ring_distance2(view.odometry, closure, passed_[i].closure);
    if (chi2 > config_.max_chi2) continue;
    agrees_with.push_back(i);
    report.consistency_chi2 = std::max(report.consistency_chi2, chi2);
  }
  agreement_.add(agrees_with);
  passed_.push_back({.closure = closure, .report = reports_.size()});
  reports_.push_back(report);
}

/// closures_ anew from the largest consistent set.
void LoopCloser::collect() {
  believed_.clear();
  closures_.clear();
  for (const std::size_t node : agreement_.largest_clique()) {
    if (!passed_[node].retracted) believed_.push_back(node);
  }
  std::ranges::sort(believed_);
  for (Passed& p : passed_) {
    reports_[p.report].ended_at = p.retracted ? LoopStage::kGraph : LoopStage::kConsistency;
  }
  for (const std::size_t node : believed_) {
    reports_[passed_[node].report].ended_at = LoopStage::kAccepted;
    closures_.push_back(passed_[node].closure);
  }
}

void LoopCloser::weigh(std::span<const double> weights) {
  for (std::size_t i = 0; i < std::min(weights.size(), believed_.size()); ++i) {
    Passed& p = passed_[believed_[i]];
    reports_[p.report].graph_weight = weights[i];
    p.doubts = weights[i] < kDoubtfulWeight ? p.doubts + 1 : 0;
    p.retracted = p.retracted || p.doubts >= kDoubtsToRetract;
  }
}

}  // namespace slamd
