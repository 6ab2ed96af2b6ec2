#include "estimator/graph/relocaliser.hpp"

#include <algorithm>
#include <utility>

#include "estimator/graph/closure_consistency.hpp"

namespace slamd {

namespace {

constexpr double kPatienceAfterRestart_m = 50.0;
constexpr double kStanding_mps = 0.3;
constexpr double kLongestCarried_s = 10.0;
constexpr double kLongestReach_m = 40.0;  // beyond the map's last keyframe: further away it shows too little of the same
constexpr double kPathShare = 0.5;      // of the way since, that it may be beside it
constexpr std::size_t kGuessTries = 8;  // keyframes of a piece that are looked for where they are believed to be

/// Where a vehicle is now that moved so when it was last seen there, and moves as `now` says: half the time the one way, half the
/// other. It may have braked, gone on or turned in between. Long after, it is as good as where it was.
PlaceBelief carried(const Pose& T_map_left, const StoredMotion& motion, const NavState& now) {
  PlaceBelief here{T_map_left};
  const double away_s = to_seconds(now.time - motion.time);
  if (away_s < 0.0 || away_s > kLongestCarried_s) return here;
  const Eigen::Vector3d velocity_mps = now.T_odom_base.rotation.conjugate() * now.velocity_mps;
  const auto moved = [half_s = 0.5 * away_s](const Eigen::Vector3d& v, const Eigen::Vector3d& turn_rads) {
    return Pose{exp_so3(half_s * turn_rads), half_s * v};
  };
  const Pose first = moved(motion.velocity_mps, motion.angular_velocity_rads);
  const Pose second = moved(velocity_mps, now.angular_velocity_rads);
  const double path_m = first.translation.norm() + second.translation.norm();
  const double turned_rad = log_so3(first.rotation).norm() + log_so3(second.rotation).norm();
  here.T_map_base = T_map_left * first * second;
  here.reach_m = kLongestReach_m;
  here.window.distance_m += kPathShare * path_m;
  here.window.yaw_rad += turned_rad;
  return here;
}

}  // namespace

Relocaliser::Relocaliser(const RelocaliserConfig& config, MakeMapper make_mapper, const Eigen::Vector3d& p_base_lidar)
    : config_{config},
      make_mapper_{std::move(make_mapper)},
      p_base_lidar_{p_base_lidar},
      mapper_{make_mapper_()},
      links_{{0, {}}},
      clouds_{config.clouds, p_base_lidar} {}

Relocaliser::Entered Relocaliser::add(const Keyframe& keyframe) {
  if (known_) waiting_.resize(std::min<std::size_t>(waiting_.size(), 1));
  if (keyframe.state.odom_piece != odom_piece_) begin_piece(keyframe.state.odom_piece);
  if (known_) {
    if (waiting_.empty()) waiting_.emplace_back();
    waiting_.front() = keyframe;
    return enter_waiting();
  }
  wait(keyframe);
  if (const std::optional<Found> place = look()) {
    join(*place);
    ++counts_.relocalised;
    return enter_waiting();
  }
  if (driven_m_ < patience_m()) return {};
  begin_anew();
  Entered entered = enter_waiting();
  entered.map_began_anew = true;
  return entered;
}

void Relocaliser::restore(StoredMap map, HostTime now) {
  if (map.keyframes.empty()) return;
  left_ = Left{map.T_map_base, map.motion};
  mapper_.restore(std::move(map), now);
  links_.clear();
  known_ = false;
}

/// Somebody may have moved the vehicle while nobody looked: one that stands has to recognise the map of an earlier run at once, if
/// only by looks, or it is not the place. One that drives sees more with every metre.
double Relocaliser::patience_m() const {
  if (!left_) return config_.patience_m;
  const bool stands = waiting_.front().state.velocity_mps.norm() < kStanding_mps;
  return stands && by_looks_.empty() ? 0.0 : std::min(config_.patience_m, kPatienceAfterRestart_m);
}

void Relocaliser::begin_piece(std::uint32_t odom_piece) {
  odom_piece_ = odom_piece;
  piece_ = {};
  clouds_ = KeyframeClouds{config_.clouds, p_base_lidar_};
  driven_m_ = 0.0;
  by_looks_.clear();
  waiting_.clear();
  known_ = mapper_.keyframes().empty();
  if (known_) links_ = {{odom_piece, {}}};
}

PlaceBelief Relocaliser::believed(const NavState& first) const {
  if (!left_) return {mapper_.keyframes().back().T_map_base};
  return left_->motion ? carried(left_->T_map_base, *left_->motion, first) : PlaceBelief{left_->T_map_base};
}

void Relocaliser::wait(const Keyframe& keyframe) {
  const Pose& T_odom_base = keyframe.state.T_odom_base;
  if (piece_.size() == 0) belief_ = believed(keyframe.state);
  if (piece_.size() > 0) {
    driven_m_ += (T_odom_base.translation - piece_.T_odom_base(piece_.size() - 1).translation).norm();
  }
  piece_.add(T_odom_base, keyframe.relative_covariance);
  clouds_.add(keyframe.points);
  if (waiting_.size() == config_.max_waiting) waiting_.erase(waiting_.begin());
  waiting_.push_back(keyframe);
}

/// Near the believed place one match is enough: it is belief and registration that agree. By looks alone two are needed, from
/// different places: what looks alike once may be another place.
std::optional<Relocaliser::Found> Relocaliser::look() {
  const std::size_t newest = piece_.size() - 1;
  if (newest < kGuessTries) {
    const PlaceBelief here{belief_.T_map_base * piece_.relative(0, newest), belief_.window, belief_.reach_m};
    if (const auto near = mapper_.recognise({piece_, clouds_}, here)) return found(*near);
  }
  if (newest % config_.look_every != 0) return std::nullopt;
  const std::optional<Recognition> alike = mapper_.recognise({piece_, clouds_}, std::nullopt);
  if (!alike) return std::nullopt;
  by_looks_.push_back(found(*alike));
  return is_confirmed(by_looks_.back()) ? std::optional{by_looks_.back()} : std::nullopt;
}

Relocaliser::Found Relocaliser::found(const Recognition& recognition) const {
  const Pose T_map_base = mapper_.keyframes()[recognition.place].T_map_base * recognition.T_place_keyframe.T_a_b;
  return {recognition, T_map_base * piece_.T_odom_base(recognition.keyframe).inverse()};
}

bool Relocaliser::is_confirmed(const Found& newest) const {
  const Pose& T_odom_base = piece_.T_odom_base(newest.recognition.keyframe);
  return std::ranges::any_of(by_looks_, [&](const Found& other) {
    const Pose& T_odom_other = piece_.T_odom_base(other.recognition.keyframe);
    const Vector6d difference = boxminus(newest.T_map_odom * T_odom_base, other.T_map_odom * T_odom_base);
    return (T_odom_base.translation - T_odom_other.translation).norm() >= config_.confirm_m &&
           difference.head<3>().norm() < config_.agree_m && difference.tail<3>().norm() < config_.agree_rad;
  });
}

/// The chain goes on from its newest keyframe to the oldest one that waits, by way of the place that was recognised: where the
/// graph has that place now, with the doubt of all the odometry in between.
void Relocaliser::join(const Found& place) {
  const std::size_t first = piece_.size() - waiting_.size();
  const GraphView map = mapper_.view();
  const std::size_t last = map.keyframes.size() - 1;
  const RelativePose T_last_first = odometry_between(map.odometry, last, place.recognition.place) *
                                    place.recognition.T_place_keyframe *
                                    odometry_between(piece_, place.recognition.keyframe, first);
  const Pose T_chain_map = map.keyframes[last].T_odom_base * map.keyframes[last].T_map_base.inverse();
  links_.push_back({odom_piece_, T_chain_map * place.T_map_odom});
  waiting_.front().relative_covariance = T_last_first.covariance;
  known_ = true;
  left_.reset();
}

Relocaliser::Entered Relocaliser::enter_waiting() {
  for (Keyframe& keyframe : waiting_) {
    keyframe.id = mapper_.keyframes().size() + mapper_.left_out_keyframes();
    keyframe.state.T_odom_base = links_.back().T_chain_odom * keyframe.state.T_odom_base;
    keyframe.state.velocity_mps = links_.back().T_chain_odom.rotation * keyframe.state.velocity_mps;
    mapper_.add(keyframe);
  }
  return {.map_began_anew = false, .keyframes = waiting_};
}

void Relocaliser::begin_anew() {
  mapper_ = make_mapper_();
  links_ = {{odom_piece_, {}}};
  known_ = true;
  left_.reset();
  ++counts_.begun_anew;
}

MapLink Relocaliser::link() const {
  const Pose T_map_odom = known_ ? mapper_.solution()->T_map_odom * links_.back().T_chain_odom : Pose{};
  return {.T_map_odom = T_map_odom, .odom_piece = odom_piece_, .known = known_};
}

std::optional<Pose> Relocaliser::T_chain_odom(std::uint32_t odom_piece) const {
  const auto found = std::ranges::find(links_, odom_piece, &Link::odom_piece);
  return found == links_.end() ? std::nullopt : std::optional{found->T_chain_odom};
}

}  // namespace slamd
