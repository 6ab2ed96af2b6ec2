#include "estimator/odometry/scan_fusion.hpp"

#include "estimator/filter/odom_frame.hpp"
#include "estimator/odometry/base_state.hpp"

namespace slamd {

namespace {

constexpr Duration kGap = std::chrono::milliseconds{300};  // between the ends of scans

}  // namespace

ScanFusion::ScanFusion(const Pose& T_base_imu, const ScanFusionConfig& config)
    : T_base_imu_{T_base_imu},
      config_{config},
      registration_{config.registration},
      velocity_search_{config.velocity_search},
      relation_{config.map_drift, T_base_imu} {}

void ScanFusion::begin(const InitialState& first) {
  registration_.clear_map();
  relation_.break_off();
  unfused_ = 0;
  odom_is_told_ = false;
  had_imu_ = first.with_imu;
  first.at_rest ? velocity_search_.end() : velocity_search_.begin(first);
}

bool ScanFusion::is_after_gap(const Scan& scan) const {
  return !velocity_search_.is_on() && had_imu_ && scan.end - fused_at_ > kGap;
}

UpdateSummary ScanFusion::match(const Scan& scan, bool coasted, FilterSnapshot& filter, StageListener* listener) {
  had_imu_ = had_imu_ || !coasted;
  const PriorMotion motion{.coasted = coasted, .alone = !had_imu_, .after_gap = is_after_gap(scan)};
  const auto finished = [listener](Stage stage) {
    if (listener != nullptr) listener->finished(stage);
  };
  registration_.deskew(scan, filter.state.T_imu_lidar);
  finished(Stage::kDeskew);
  UpdateSummary update;
  if (map().size() > 0) update = registration_.update(scan, motion, filter, listener);
  finished(Stage::kSolve);
  return update;
}

/// What the update means for the map. While the velocity is being found scans are skewed by what is wrong with it, so each
/// is compared with the one before only.
void ScanFusion::absorb(const Scan& scan, const UpdateSummary& update, FilterSnapshot& filter) {
  const bool after_gap = is_after_gap(scan);
  const bool makes_map = registration_.segments() >= config_.registration.update.min_inliers;
  const bool first = map().size() == 0 && makes_map;
  const bool searching = velocity_search_.is_on();
  const bool overdue = velocity_search_.is_overdue(filter.time);
  if (!first) ++(update.fused ? stats_.fused : stats_.unfused);
  unfused_ = update.fused || first ? 0 : unfused_ + 1;
  const bool skewed = searching && update.fused && velocity_search_.fused(update, filter);
  const std::uint32_t patience = searching ? velocity_search_.max_unfused() : config_.max_unfused_scans;
  const bool gives_up = makes_map && unfused_ > patience;
  if (gives_up) velocity_search_.begin_round();
  restarted_ = gives_up || (overdue && !velocity_search_.is_on());
  if (restarted_) ++stats_.map_restarts;
  const NewMap new_map{.defines_odom = searching || !odom_is_told_, .moving = skewed || gives_up};
  if (first || gives_up || skewed) begin_map(new_map, filter);
  const bool spoils_map = after_gap && !update.sure && map().size() > 0;
  if (unfused_ == 0 && !spoils_map) registration_.insert(filter.state);
  if (unfused_ == 0) fused_at_ = scan.end;
  odom_is_told_ = true;
}

/// Forgets the local map. What the pose does not know of itself from now on is the new map's own uncertainty; a map that
/// defines odom has none but its own tilt.
void ScanFusion::begin_map(const NewMap& map, FilterSnapshot& filter) {
  registration_.clear_map();
  relation_.keep_before_new_map(filter);
  const Matrix6d so_far = base_state(filter, T_base_imu_).covariance;
  const Eigen::Vector3d up_imu = filter.state.R_odom_imu.conjugate() * -filter.state.gravity;
  define_odom(map.defines_odom ? level_pose(up_imu, T_base_imu_) : filter.state.T_odom_imu(), filter);
  filter.map_covariance = first_drift(config_.map_drift);
  if (map.moving) filter.map_covariance += skew_drift(config_.map_drift, filter);
  if (!map.defines_odom) filter.map_covariance += so_far;
  unfused_ = 0;
}

void ScanFusion::carry_drift(const FilterSnapshot& before, FilterSnapshot& filter) {
  const Pose T_imu_base = T_base_imu_.inverse();
  const Pose T_odom_before = before.state.T_odom_imu() * T_imu_base;
  const Pose T_odom_base = filter.state.T_odom_imu() * T_imu_base;
  const bool inserted = unfused_ == 0;
  const Matrix6d local = inserted ? local_covariance(filter, T_base_imu_) : Matrix6d::Zero();
  Matrix6d& drift = filter.map_covariance;
  drift = slamd::carry_drift(config_.map_drift, drift, T_odom_before, T_odom_base, local);
  relation_.carry(T_odom_before, T_odom_base, local);
}

bool ScanFusion::map_is_mature() const {
  constexpr std::uint32_t kEnoughViewpoints = 20;
  return map().viewpoints() >= kEnoughViewpoints;
}

}  // namespace slamd
