#include "estimator/graph/gnss_alignment.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slamd {

namespace {

constexpr double kUnusedHeight_m = 1.0e4;  // sigma of a height that is left out
constexpr double kMaxVelocityInnovation_mps = 1.5;
constexpr double kDoubtfulWeight = 0.1;
constexpr std::size_t kBatch = 10;         // new positions that are worth a solve
constexpr std::size_t kMostRefused = 100'000;  // reports of fixes at rest: a parked vehicle must not fill the memory

/// Of the horizontal prediction: alignment and what odometry may have drifted since the fix before it.
Eigen::Matrix2d prediction_covariance(const EnuAlignment& alignment, const Eigen::Vector3d& p_map, double drift_m2) {
  const Eigen::Vector2d turned = Eigen::Rotation2Dd{alignment.yaw_rad} * p_map.head<2>();
  Eigen::Matrix<double, 2, 4> J = Eigen::Matrix<double, 2, 4>::Zero();
  J(0, 0) = J(1, 1) = 1.0;
  J.col(3) << -turned.y(), turned.x();
  return J * alignment.covariance * J.transpose() + drift_m2 * Eigen::Matrix2d::Identity();
}

}  // namespace

GnssAlignment::GnssAlignment(const GnssAlignmentConfig& config, const Eigen::Vector3d& p_base_antenna)
    : config_{config},
      track_{p_base_antenna},
      latch_{config.trust} {}

void GnssAlignment::add(const GnssFix& fix) {
  FixReport report{.number = arrived_++,
                   .time = fix.time,
                   .chi2 = std::numeric_limits<double>::quiet_NaN(),
                   .sigma_m = fix.sigma_horizontal_m};
  if (!is_usable(fix, report)) {
    if (report.verdict == FixVerdict::kQuality) latch_.judge(fix.time, false);
    refuse(report);
    return;
  }
  if (!enu_) {
    enu_.emplace(GeodeticPosition{fix.latitude_deg, fix.longitude_deg, fix.height_valid ? fix.height_m : 0.0},
                 config_.projection);
  }
  pending_.push_back({fix, report});
}

void GnssAlignment::refuse(const FixReport& report) {
  refused_.push_back(report);
  if (refused_.size() > kMostRefused) refused_.pop_front();
}

std::vector<FixReport> GnssAlignment::reports() const {
  std::vector<FixReport> all{refused_.begin(), refused_.end()};
  for (const TiedFix& fix : tied_) all.push_back(fix.report);
  for (const Pending& pending : pending_) all.push_back(pending.report);
  std::ranges::sort(all, {}, &FixReport::number);
  return all;
}

std::size_t GnssAlignment::bytes() const {
  const std::size_t a_fix = sizeof(Pending) + sizeof(TiedFix) + sizeof(EnuPair);  // the last while it is fitted
  return track_.bytes() + tied_.size() * a_fix + refused_.size() * sizeof(FixReport) +
         positions_.size() * sizeof(GnssPosition);
}

bool GnssAlignment::is_usable(const GnssFix& fix, FixReport& report) const {
  const bool finite = std::isfinite(fix.latitude_deg) && std::isfinite(fix.longitude_deg) && std::isfinite(fix.height_m);
  const bool has_position = fix.quality != GnssQuality::kNone && fix.quality != GnssQuality::kDeadReckoning;
  const bool strong = fix.sigma_horizontal_m > 0.0 && fix.sigma_horizontal_m <= config_.max_sigma_m;
  const bool in_order = pending_.empty() || fix.time > pending_.back().fix.time;
  if (fix.stale || !in_order) report.verdict = FixVerdict::kStale;
  else if (!finite || !has_position || !strong) report.verdict = FixVerdict::kQuality;
  else return true;
  return false;
}

void GnssAlignment::tie_pending() {
  const Duration late = from_seconds(latency_.believed_s());
  while (!pending_.empty() && !track_.is_ahead(pending_.front().fix.time - late)) {
    const Pending& pending = pending_.front();
    const GnssFix& fix = pending.fix;
    const Eigen::Vector3d p_enu = enu_->to_enu({fix.latitude_deg, fix.longitude_deg, fix.height_m});
    std::optional<TiedFix> tied = track_.tie(fix, fix.time - late, p_enu);
    if (tied) {
      tied->report = pending.report;
      if (!tied_.empty()) tied->since_last_s = to_seconds(tied->time - tied_.back().time);
      FixVerdict& verdict = tied->report.verdict;
      if (verdict == FixVerdict::kUntied) verdict = FixVerdict::kUnaligned;  // a fix that is tied anew keeps its own
      tied_.push_back(*tied);
      fixes_.push_back(pending);
    } else {
      refuse(pending.report);
    }
    pending_.pop_front();
  }
}

/// All fixes once more with the latency believed now.
void GnssAlignment::tie_anew() {
  for (std::size_t i = 0; i < tied_.size(); ++i) fixes_[i].report = tied_[i].report;
  pending_.insert(pending_.begin(), fixes_.begin(), fixes_.end());
  fixes_.clear();
  tied_.clear();
  tie_pending();
}

/// Of an independent sample.
double GnssAlignment::share_of(const TiedFix& fix) const {
  return std::min(1.0, fix.since_last_s / (2.0 * config_.fit.correlation_s));
}

EnuPair GnssAlignment::pair_of(const TiedFix& fix, const GraphView& view) const {
  const GnssPosition& position = fix.position;
  const Pose& T_map_base = view.keyframes[position.keyframe].T_map_base;
  return {T_map_base * position.p_keyframe_antenna, position.p_enu, position.sigma_m, share_of(fix)};
}

std::vector<EnuPair> GnssAlignment::pairs(const GraphView& view) const {
  std::vector<EnuPair> result;
  result.reserve(tied_.size());
  for (const TiedFix& fix : tied_) result.push_back(pair_of(fix, view));
  return result;
}

void GnssAlignment::refit(const GraphView& view) {
  fitted_ = tied_.size();
  std::optional<EnuFit> fit = fit_enu(pairs(view), config_.fit);
  if (!fit) return;  // what was known stays known
  const bool first = !fit_;
  fit_ = std::move(fit);
  if (first) judged_ = 0;
  const GnssLatency latency = latency_.estimate();
  if (first || !config_.estimate_latency || !latency.significant()) return;
  latency_.shift(latency.correction_s);
  tie_anew();
  fit_ = fit_enu(pairs(view), config_.fit);
  judged_ = tied_.size();
}

GnssLatency GnssAlignment::latency() const {
  const GnssLatency rest = latency_.estimate();
  return {latency_.believed_s() + rest.correction_s, rest.sigma_s};
}

bool GnssAlignment::update(const GraphView& view, const std::optional<EnuAlignment>& alignment) {
  tie_pending();
  const bool known = fit_.has_value();
  const std::size_t grown = static_cast<std::size_t>(config_.refit_growth * static_cast<double>(fitted_));
  const bool due = tied_.size() >= fitted_ + std::max<std::size_t>(config_.refit_every, grown);
  if (due) refit(view);
  if (!fit_) return false;
  if (bends_ && alignment) fit_->alignment = *alignment;
  judge_from(view, judged_);
  if (!due) return false;
  bends_ = bends_ || contradicts_track(view);
  if (!bends_) return !known;
  const std::size_t before = positions_.size();
  choose_positions();
  return !known || positions_.size() >= before + kBatch || positions_.size() < before;
}

void GnssAlignment::judge_from(const GraphView& view, std::size_t first) {
  for (std::size_t i = first; i < tied_.size(); ++i) judge(view, fit_->alignment, tied_[i]);
  judged_ = tied_.size();
}

void GnssAlignment::judge(const GraphView& view, const EnuAlignment& alignment, TiedFix& fix) {
  const EnuPair pair = pair_of(fix, view);
  const Eigen::Vector3d innovation = pair.p_enu - alignment.T_enu_map() * pair.p_map;
  const std::size_t keyframe = fix.position.keyframe;
  const Matrix6d drift = view.odometry.relative_covariance(keyframe > 50 ? keyframe - 50 : 0, keyframe);
  const Eigen::Matrix2d S = prediction_covariance(alignment, pair.p_map, drift.topLeftCorner<2, 2>().trace()) +
                            pair.sigma_m.x() * pair.sigma_m.x() * Eigen::Matrix2d::Identity();
  FixReport& report = fix.report;
  report.chi2 = innovation.head<2>().dot(S.ldlt().solve(innovation.head<2>()));
  report.innovation_m = innovation.head<2>().norm();
  const bool inside = report.chi2 <= config_.max_chi2_horizontal;
  const bool trusted = latch_.judge(fix.time, inside);
  report.verdict = !inside ? FixVerdict::kInnovation : trusted ? FixVerdict::kAccepted : FixVerdict::kDistrusted;
  const double variance_up = alignment.covariance(2, 2) + drift(2, 2) + pair.sigma_m.z() * pair.sigma_m.z();
  if (innovation.z() * innovation.z() > config_.max_chi2_vertical * variance_up) fix.position.sigma_m.z() = kUnusedHeight_m;
  if (report.verdict != FixVerdict::kAccepted) return;
  const Pose T_map_odom = view.keyframes[keyframe].T_map_base * view.keyframes[keyframe].T_odom_base.inverse();
  time_by(fix, innovation.head<2>(), alignment.T_enu_map().rotation * T_map_odom.rotation);
}

/// What an accepted fix says of its own age.
void GnssAlignment::time_by(const TiedFix& fix, const Eigen::Vector2d& innovation_m, const Eigen::Quaterniond& R_enu_odom) {
  const Eigen::Vector2d velocity = (R_enu_odom * fix.velocity_odom_mps).head<2>();
  const double sigma_m = fix.position.sigma_m.x();
  // What lasts looks like latency only until the vehicle has turned: it counts against it for half as long as elsewhere.
  const double share = std::min(1.0, 2.0 * share_of(fix));
  latency_.add_position(innovation_m, velocity, share / (sigma_m * sigma_m));
  if (!fix.velocity_enu_mps) return;
  const Eigen::Vector2d innovation_mps = *fix.velocity_enu_mps - velocity;
  if (innovation_mps.norm() > kMaxVelocityInnovation_mps) return;
  const double weight = std::min(1.0, fix.since_last_s) / (config_.velocity_sigma_mps * config_.velocity_sigma_mps);
  latency_.add_velocity(innovation_mps, (R_enu_odom * fix.acceleration_odom_mps2).head<2>(), weight);
}

/// Do means over stretches as long as the receiver's errors last differ from a rigid track by more than these errors?
bool GnssAlignment::contradicts_track(const GraphView& view) const {
  const Duration stretch = from_seconds(config_.fit.correlation_s);
  double chi2 = 0.0;
  double stretches = 0.0;
  for (std::size_t i = 0; i < tied_.size();) {
    const HostTime end = tied_[i].time + stretch;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double sigma2 = 0.0;
    double count = 0.0;
    for (; i < tied_.size() && tied_[i].time < end; ++i) {
      if (tied_[i].report.verdict != FixVerdict::kAccepted) continue;
      const EnuPair pair = pair_of(tied_[i], view);
      sum += (pair.p_enu - fit_->alignment.T_enu_map() * pair.p_map).head<2>();
      sigma2 += pair.sigma_m.x() * pair.sigma_m.x();
      count += 1.0;
    }
    if (count < config_.fit.min_fixes) continue;
    chi2 += (sum / count).squaredNorm() / (sigma2 / count);
    stretches += 1.0;
  }
  const double freedom = 2.0 * stretches;
  return stretches >= 2.0 && chi2 > freedom + 3.1 * std::sqrt(2.0 * freedom);
}

/// At most one in position_period_s, its sigma widened so that errors that last count once.
void GnssAlignment::choose_positions() {
  positions_.clear();
  const double widening = std::sqrt(std::max(1.0, 2.0 * config_.fit.correlation_s / config_.position_period_s));
  std::optional<HostTime> last;
  for (const TiedFix& fix : tied_) {
    if (fix.report.verdict != FixVerdict::kAccepted) continue;
    if (last && fix.time - *last < from_seconds(config_.position_period_s)) continue;
    last = fix.time;
    positions_.push_back(fix.position);
    positions_.back().sigma_m *= widening;
  }
}

std::optional<EnuAlignment> GnssAlignment::initial_alignment() const {
  if (!fit_) return std::nullopt;
  return fit_->alignment;
}

EnuOrigin GnssAlignment::origin() const {
  if (!enu_) return {};
  return {enu_->origin().latitude_deg, enu_->origin().longitude_deg, enu_->origin().height_m};
}

void GnssAlignment::weigh(std::span<const double> weights) {
  std::size_t next = 0;
  for (TiedFix& fix : tied_) {
    if (next == std::min(weights.size(), positions_.size())) return;
    if (fix.position.keyframe != positions_[next].keyframe || fix.position.p_enu != positions_[next].p_enu) continue;
    if (weights[next] < kDoubtfulWeight) fix.report.verdict = FixVerdict::kInnovation;
    ++next;
  }
}

}  // namespace slamd
