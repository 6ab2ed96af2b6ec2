#include "estimator/odometry/lidar_inertial_odometry.hpp"

#include "estimator/odometry/base_state.hpp"

namespace slamd {

using I = ErrorIndex;

namespace {

constexpr Duration kSilentPeriod = std::chrono::milliseconds{100};

bool is_sane(const FilterSnapshot& filter) {
  const InertialState& state = filter.state;
  return state.R_odom_imu.coeffs().allFinite() && state.p_odom_imu.allFinite() && state.v_odom_imu.allFinite() &&
         filter.covariance.allFinite() && (filter.covariance.diagonal().array() >= 0.0).all();
}

}  // namespace

LidarInertialOdometry::LidarInertialOdometry(const VehicleGeometry& geometry, const OdometryConfig& config)
    : geometry_{geometry},
      config_{config},
      imu_{config.imu},
      queue_{config.scans},
      starter_{geometry, config.start},
      matcher_{{.dead_reckoning = config.dead_reckoning,
                .imu_doubt = config.imu_doubt,
                .min_inliers = config.fusion.registration.update.min_inliers,
                .max_test_ratio = config.status.max_test_ratio}},
      fusion_{geometry.T_base_imu, config.fusion},
      keyframes_{config.keyframes, config.scans.assembler.max_points} {}

void LidarInertialOdometry::add(const ImuSample& sample) {
  now_ = std::max(now_, sample.arrival);
  const bool was_sane = imu_.sanity().is_sane();
  if (imu_.add(sample)) starter_.add(sample);
  if (!was_sane || imu_.sanity().is_sane()) return;
  // The fault began some samples ago: they are taken back, and what the filter made of them.
  starter_.forget_samples();
  if (filter_.time > imu_.sanity().faulty_since()) filter_ = trusted_;
}

void LidarInertialOdometry::add(const LidarPacket& packet) {
  now_ = std::max(now_, packet.arrival);
  queue_.add(packet);
}

void LidarInertialOdometry::advance(HostTime now) { now_ = std::max(now_, now); }

std::optional<HostTime> LidarInertialOdometry::due() const {
  return queue_.is_due(imu_, now_) ? std::optional{queue_.end()} : std::nullopt;
}

const ScanResult* LidarInertialOdometry::step(double share) {
  if (queue_.is_due(imu_, now_)) {
    const Scan& scan = queue_.take();
    if (share <= 0.0) {
      ++stats_.scans_let_go;
      return nullptr;
    }
    if (share < 1.0) ++stats_.scans_thinned;
    fusion_.limit(std::min(share, 1.0));
    return fuse(scan);
  }
  return is_silent() ? pass_time() : nullptr;
}

const ScanResult* LidarInertialOdometry::fuse(const Scan& scan) {
  if (!starter_.is_done() && !start(scan)) {
    return not_yet(scan.end, imu_.is_alive(scan.end) ? 0U : bit(StatusReason::kNoImu));
  }
  if (scan.end <= filter_.time) {
    ++stats_.scans_late;
    return nullptr;
  }
  if (has_lost_its_way(scan)) return start_over(scan.end);
  result_ = {};
  result_.has_scan = true;
  last_scan_ = scan.end;
  const bool was_lost = fusion_.velocity_search().is_overdue(scan.end);
  const FilterSnapshot before = filter_;
  const ScanMatch match = matcher_.match(scan, imu_.samples(), is_clock_unsure(scan.end), fusion_, filter_);
  result_.update = match.update;
  result_.imu_contradicted = match.imu_contradicted;
  if (match.imu_contradicted) ++stats_.imu_contradicted;
  fuse_standstill();
  fusion_.absorb(scan, result_.update, filter_);
  finished(Stage::kInsert);
  if (!is_sane(filter_)) return start_over(scan.end);
  if (was_lost && !fusion_.velocity_search().is_on()) ++stats_.resets;
  fusion_.carry_drift(before, filter_);
  conclude(match.carried, scan.complete);
  pick_keyframe(scan);
  const bool new_map = fusion_.restarted() || fusion_.velocity_search().is_on();
  if (!imu_.sanity().is_suspect() || new_map) trusted_ = filter_;
  finished(Stage::kKeyframe);
  return &result_;
}

bool LidarInertialOdometry::start(const Scan& scan) {
  const bool with_extrinsic = config_.fusion.registration.update.estimate_extrinsic;
  const std::optional<InitialState> first = starter_.state(scan, imu_.is_alive(scan.end), with_extrinsic);
  if (!first) return false;
  filter_ = trusted_ = first->filter;
  fusion_.begin(*first);
  return true;
}

/// After the scan, which knows better whether the vehicle moves where it knows anything of it.
void LidarInertialOdometry::fuse_standstill() {
  const bool knows = result_.update.fused && !fusion_.velocity_search().is_on() && !result_.imu_contradicted;
  if (!knows || !imu_.is_alive(filter_.time) || !is_standing(config_.standstill, imu_.samples(), filter_.time)) return;
  if (update_standstill(config_.standstill, filter_)) ++stats_.standstills;
}

bool LidarInertialOdometry::is_clock_unsure(HostTime at) const {
  return imu_.is_clock_unsure(at) || queue_.is_clock_unsure(at);
}

void LidarInertialOdometry::pick_keyframe(const Scan& scan) {
  const NavState& state = result_.state;
  const bool sure = !fusion_.velocity_search().is_on() && fusion_.unfused() == 0 && !imu_.sanity().is_suspect();
  if (!sure || !keyframes_.is_due(state.T_odom_base)) return;
  keyframes_.take(scan, fusion_.motion(), geometry_.T_base_imu * filter_.state.T_imu_lidar, state.T_odom_base);
  result_.is_keyframe = true;
  result_.relative_covariance = fusion_.keyframe_relation().take(filter_);
  result_.up = up_direction(filter_, geometry_.T_base_imu);
  result_.scan_span = scan.end - scan.begin;
}

/// LOST, and not by scans that fit but leave a direction free: what the local map is compared with at a pose that is metres
/// off agrees by chance only. Without an IMU a new start finds no motion either.
bool LidarInertialOdometry::has_lost_its_way(const Scan& scan) const {
  if (fusion_.velocity_search().is_on() || !imu_.is_alive(scan.begin)) return false;
  const bool was_silent = scan.begin - last_scan_ > from_seconds(config_.lidar_timeout_s);
  return (was_silent || fusion_.unfused() > 0) && local_sigma_m() > config_.status.lost_sigma_m;
}

/// Of position, relative to the local map.
double LidarInertialOdometry::local_sigma_m() const {
  return std::sqrt(filter_.covariance.block<3, 3>(I::kPosition, I::kPosition).trace());
}

/// A state that is lost, or no number any more, cannot be mended by further measurements: initialise anew.
const ScanResult* LidarInertialOdometry::start_over(HostTime time) {
  ++stats_.resets;
  starter_.clear();
  keyframes_.forget();
  filter_ = {};
  filter_.time = time;
  return not_yet(time, bit(StatusReason::kReset));
}

const ScanResult* LidarInertialOdometry::not_yet(HostTime time, std::uint32_t reasons) {
  result_ = {};
  result_.has_scan = true;
  result_.state.time = result_.snapshot.time = time;
  result_.state.odom_piece = odom_piece();
  result_.state.reasons = reasons;
  return &result_;
}

bool LidarInertialOdometry::is_silent() const {
  return starter_.is_done() && queue_.empty() && now_ - last_scan_ > from_seconds(config_.lidar_timeout_s) &&
         now_ - queue_.latency() >= filter_.time + kSilentPeriod;
}

const ScanResult* LidarInertialOdometry::pass_time() {
  result_ = {};
  const DeadReckoningSummary carried = matcher_.pass(imu_.samples(), now_ - queue_.latency(), filter_);
  if (!is_sane(filter_)) return start_over(filter_.time);
  conclude(carried, true);
  return &result_;
}

/// The result of what the filter now holds.
void LidarInertialOdometry::conclude(const DeadReckoningSummary& carried, bool complete_scan) {
  NavState& state = result_.state;
  state = base_state(filter_, geometry_.T_base_imu);
  state.odom_piece = odom_piece();
  result_.snapshot = filter_;
  const Judgement judgement = judge(
      config_.status,
      {.has_scan = result_.has_scan,
       .complete_scan = complete_scan,
       .imu_is_alive = imu_.is_alive(state.time),
       .coasted = carried.coasted_s > 0.0,
       .clipped = carried.clipped,
       .imu_contradicted = result_.imu_contradicted,
       .clock_unsure = is_clock_unsure(state.time),
       .map_is_mature = fusion_.map_is_mature(),
       .map_restarted = fusion_.restarted(),
       .velocity_unknown = fusion_.velocity_search().is_on(),
       .velocity_overdue = fusion_.velocity_search().is_overdue(state.time),
       .unfused_scans = fusion_.unfused(),
       .local_sigma_m = local_sigma_m(),
       .update = result_.update});
  state.status = judgement.status;
  state.reasons = judgement.reasons;
  state.lidar_test_ratio = judgement.lidar_test_ratio;
  state.degenerate_direction = result_.update.free_direction;
}

OdometryStats LidarInertialOdometry::stats() const {
  OdometryStats all = stats_;
  all.imu = imu_.stats();
  all.queue = queue_.stats();
  all.fusion = fusion_.stats();
  return all;
}

}  // namespace slamd
