#include "estimator/odometry/lidar_inertial_odometry.hpp"

#include "estimator/odometry/base_state.hpp"

namespace slamd {

using I = ErrorIndex;

namespace {

bool is_sane(const FilterSnapshot& filter) {
  const InertialState& state = filter.state;
  return state.R_odom_imu.coeffs().allFinite() && state.p_odom_imu.allFinite() && state.v_odom_imu.allFinite() &&
         filter.covariance.allFinite() && (filter.covariance.diagonal().array() >= 0.0).all();
}

}  // namespace

LidarInertialOdometry::LidarInertialOdometry(const VehicleGeometry& geometry, const OdometryConfig& config)
    : geometry_{geometry},
      config_{config},
      assembler_{config.scan},
      initialisation_{config.initialisation},
      dead_reckoning_{config.dead_reckoning},
      registration_{config.registration},
      relation_{config.map_drift, geometry.T_base_imu} {
  pending_.points.reserve(config.scan.max_points);
  pending_.segments.reserve(config.scan.max_segments);
  keyframe_points_.reserve(config.scan.max_points);
}

void LidarInertialOdometry::add(const ImuSample& sample) {
  now_ = std::max(now_, sample.arrival);
  if (!samples_.push(sample)) {
    ++stats_.imu_rejected;
  } else if (!progress_.initialised) {
    initialisation_.add(sample);
  }
}

void LidarInertialOdometry::add(const LidarPacket& packet) {
  now_ = std::max(now_, packet.arrival);
  if (!assembler_.add(packet)) return;
  if (has_pending_) ++stats_.scans_late;
  assembler_.take(pending_);
  has_pending_ = true;
  ++stats_.scans;
}

void LidarInertialOdometry::advance(HostTime now) { now_ = std::max(now_, now); }

const ScanResult* LidarInertialOdometry::step() {
  if (has_pending_ && is_due(pending_)) return fuse();
  const bool silent = progress_.initialised && to_seconds(now_ - filter_.time) > config_.lidar_timeout_s;
  return silent && !has_pending_ ? pass_time() : nullptr;
}

bool LidarInertialOdometry::imu_is_alive(HostTime at) const {
  return !samples_.empty() && at - samples_.newest().time < from_seconds(config_.imu_timeout_s);
}

bool LidarInertialOdometry::is_due(const Scan& scan) const {
  if (!samples_.empty() && samples_.newest().time >= scan.end) return true;
  return !imu_is_alive(scan.end) || now_ - scan.arrival > from_seconds(config_.imu_deadline_s);
}

const ScanResult* LidarInertialOdometry::fuse() {
  has_pending_ = false;
  result_ = {};
  result_.has_scan = true;
  if (!progress_.initialised && !initialise(pending_)) {
    result_.state.time = result_.snapshot.time = pending_.end;
    return &result_;
  }
  if (pending_.end <= filter_.time) {
    ++stats_.scans_late;
    return nullptr;
  }
  const InertialState before = filter_.state;
  const Pose T_imu_base = geometry_.T_base_imu.inverse();
  const double elapsed_s = to_seconds(pending_.end - filter_.time);
  carry_to(pending_);
  finished(Stage::kPropagate);
  registration_.deskew(pending_, filter_.state.T_imu_lidar);
  finished(Stage::kDeskew);
  absorb(pending_);
  finished(Stage::kInsert);
  if (!is_sane(filter_)) return start_over();
  if (progress_.coasted) estimate_rate(before, elapsed_s);
  const Pose T_odom_before = before.T_odom_imu() * T_imu_base;
  const Pose T_odom_base = filter_.state.T_odom_imu() * T_imu_base;
  filter_.map_covariance = carry_drift(config_.map_drift, filter_.map_covariance, T_odom_before, T_odom_base);
  relation_.carry(T_odom_before, T_odom_base);
  result_.snapshot = filter_;
  result_.state = base_state(filter_, geometry_.T_base_imu);
  judge();
  collect_keyframe(pending_);
  finished(Stage::kKeyframe);
  return &result_;
}

bool LidarInertialOdometry::initialise(const Scan& scan) {
  const Pose T_imu_lidar = geometry_.T_base_imu.inverse() * geometry_.T_base_lidar;
  InitialState initial;
  if (imu_is_alive(scan.end)) {
    if (!initialisation_.is_ready()) return false;
    const bool with_extrinsic = config_.registration.update.estimate_extrinsic;
    initial = initialisation_.state(scan.begin, geometry_.T_base_imu, T_imu_lidar, with_extrinsic);
  } else {
    initial = initial_state_without_imu(scan.begin, config_.initialisation, geometry_.T_base_imu, T_imu_lidar);
  }
  filter_ = initial_ = initial.filter;
  progress_.initialised = true;
  progress_.moving_start_left = initial.at_rest ? 0 : config_.moving_start_scans;
  initialisation_.clear();
  return true;
}

/// Dead reckoning to the scan's end; the knots inside the scan go to the de-skewing.
void LidarInertialOdometry::carry_to(const Scan& scan) {
  ScanMotion& motion = registration_.motion();
  motion.clear();
  const auto nothing = [](const FilterSnapshot&) {};
  const auto add_knot = [&](const FilterSnapshot& at) {
    motion.add(to_seconds(at.time - scan.begin), at.state.T_odom_imu());
  };
  DeadReckoningSummary before_scan;
  if (filter_.time < scan.begin) before_scan = dead_reckoning_.advance(samples_, scan.begin, filter_, nothing);
  add_knot(filter_);
  const DeadReckoningSummary in_scan = dead_reckoning_.advance(samples_, scan.end, filter_, add_knot);
  progress_.coasted = before_scan.coasted_s + in_scan.coasted_s > 0.0;
  progress_.clipped = before_scan.clipped || in_scan.clipped;
  progress_.complete_scan = scan.complete;
  progress_.restarted = false;
}

/// Update and insertion, or the beginning of a map where there is none to compare with.
void LidarInertialOdometry::absorb(const Scan& scan) {
  const bool first = registration_.map().size() == 0;
  if (!first) result_.update = registration_.update(scan, filter_, listener_);
  finished(Stage::kSolve);
  const bool fused = result_.update.fused;
  if (!first) fused ? ++stats_.scans_fused : ++stats_.scans_unfused;
  progress_.unfused = fused || first ? 0 : progress_.unfused + 1;
  const bool velocity_unknown = progress_.moving_start_left > 0 && fused;
  if (velocity_unknown) keep_velocity_only();
  const bool gives_up = progress_.unfused > config_.max_unfused_scans;
  if (first || velocity_unknown || gives_up) begin_map_here(!gives_up);
  if (first || progress_.unfused == 0) registration_.insert(filter_.state);
  ++progress_.scans;
}

/// While the velocity is being found scans are skewed by what is wrong with it, so each is compared with the one before
/// only, and what the filter learns from them of biases and gravity is not kept.
void LidarInertialOdometry::keep_velocity_only() {
  --progress_.moving_start_left;
  filter_.state.gyro_bias = initial_.state.gyro_bias;
  filter_.state.accel_bias = initial_.state.accel_bias;
  filter_.state.gravity = initial_.state.gravity;
  filter_.covariance = initial_.covariance;
  const double variance = config_.found_velocity_sigma_mps * config_.found_velocity_sigma_mps;
  filter_.covariance.diagonal().segment<3>(I::kVelocity).setConstant(variance);
}

/// Forgets the local map. What the pose does not know of itself from now on is the new map's own uncertainty; a map that
/// defines odom has none but its own tilt.
void LidarInertialOdometry::begin_map_here(bool defines_odom) {
  registration_.clear_map();
  relation_.keep_before_new_map(filter_);
  const Matrix6d so_far = base_state(filter_, geometry_.T_base_imu).covariance;
  filter_.map_covariance = first_drift(config_.map_drift);
  if (!defines_odom) {
    filter_.map_covariance += so_far;
    progress_.restarted = true;
    ++stats_.map_restarts;
  }
  filter_.covariance.topRows<6>().setZero();
  filter_.covariance.leftCols<6>().setZero();
  progress_.unfused = 0;
}

/// Without gyro the body rate is what turned the vehicle from one posterior to the next.
void LidarInertialOdometry::estimate_rate(const InertialState& before, double elapsed_s) {
  if (!result_.update.fused || elapsed_s <= 0.0) return;
  filter_.angular_velocity_rads = log_so3(before.R_odom_imu.conjugate() * filter_.state.R_odom_imu) / elapsed_s;
}

/// A state that is no number any more cannot be mended by further measurements: initialise anew.
const ScanResult* LidarInertialOdometry::start_over() {
  registration_.clear_map();
  relation_.break_off();
  initialisation_.clear();
  filter_ = {};
  filter_.time = pending_.end;
  progress_ = {};
  result_ = {};
  result_.has_scan = true;
  result_.state.time = result_.snapshot.time = pending_.end;
  result_.state.reasons = bit(StatusReason::kReset);
  ++stats_.resets;
  return &result_;
}

const ScanResult* LidarInertialOdometry::pass_time() {
  constexpr Duration kLag = std::chrono::milliseconds{300};  // a late scan may still be fused
  result_ = {};
  const DeadReckoningSummary summary =
      dead_reckoning_.advance(samples_, now_ - kLag, filter_, [](const FilterSnapshot&) {});
  progress_.coasted = summary.coasted_s > 0.0;
  progress_.clipped = summary.clipped;
  result_.snapshot = filter_;
  result_.state = base_state(filter_, geometry_.T_base_imu);
  judge();
  return &result_;
}

void LidarInertialOdometry::judge() {
  NavState& state = result_.state;
  const UpdateSummary& update = result_.update;
  const auto say = [&](bool holds, StatusReason reason) { state.reasons |= holds ? bit(reason) : 0U; };
  say(!imu_is_alive(state.time), StatusReason::kNoImu);
  say(progress_.coasted && imu_is_alive(state.time), StatusReason::kImuGap);
  say(progress_.clipped, StatusReason::kImuClipped);
  say(!result_.has_scan, StatusReason::kNoLidar);
  say(result_.has_scan && !progress_.complete_scan, StatusReason::kLidarIncomplete);
  say(update.free_translations > 0, StatusReason::kDegenerateTranslation);
  say(update.free_rotations > 0, StatusReason::kDegenerateRotation);
  say(progress_.unfused > 0, StatusReason::kFewInliers);
  say(progress_.restarted, StatusReason::kReset);
  // Planes seen from few places flatter themselves: only a mature map can be contradicted.
  const bool mature = registration_.map().viewpoints() >= config_.registration.update.mature_viewpoints;
  say(update.fused && mature && update.test_ratio > config_.max_test_ratio, StatusReason::kInnovation);
  // Relative to the map around: drift from odom's origin does not make a pose useless.
  const double local_sigma = std::sqrt(filter_.covariance.block<3, 3>(I::kPosition, I::kPosition).trace());
  say(local_sigma > config_.usable_sigma_m, StatusReason::kHighUncertainty);
  state.degenerate_direction = update.free_direction;
  state.lidar_test_ratio = static_cast<float>(update.test_ratio / config_.max_test_ratio);
  state.status = state.reasons == 0 ? TrackingStatus::kTracking : TrackingStatus::kDegraded;
  if (local_sigma > config_.lost_sigma_m) state.status = TrackingStatus::kLost;
  if (progress_.moving_start_left > 0) state.status = TrackingStatus::kInitialising;
}

void LidarInertialOdometry::collect_keyframe(const Scan& scan) {
  if (result_.state.status == TrackingStatus::kInitialising || progress_.unfused > 0) return;
  const Pose& T_odom_base = result_.state.T_odom_base;
  const Pose T_last_base = last_keyframe_.value_or(T_odom_base).inverse() * T_odom_base;
  const bool moved = T_last_base.translation.norm() >= config_.keyframe_distance_m ||
                     log_so3(T_last_base.rotation).norm() >= config_.keyframe_angle_rad;
  if (last_keyframe_ && !moved) return;
  last_keyframe_ = T_odom_base;
  result_.is_keyframe = true;
  result_.relative_covariance = relation_.take(filter_);
  result_.up = up_direction(filter_, geometry_.T_base_imu);
  keyframe_points_.clear();
  const Pose T_base_lidar = geometry_.T_base_imu * filter_.state.T_imu_lidar;
  const Eigen::Matrix3f R = T_base_lidar.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_base_lidar.translation.cast<float>();
  for (const LidarPoint& point : scan.points) {
    const float time_s = static_cast<float>(point.time_offset_ns) * 1e-9F;
    const Eigen::Vector3f p = R * registration_.motion().deskew({point.x, point.y, point.z}, time_s) + t;
    keyframe_points_.push_back({p.x(), p.y(), p.z(), static_cast<float>(point.intensity)});
  }
}

}  // namespace slamd
