#include "estimator/grid/planar_odometry.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "estimator/grid/planar_covariance.hpp"

namespace slamd {
namespace {

constexpr double kUnknownSigma_m = 1e3;  // of what a plane does not tell: height, and without an IMU roll and pitch
constexpr double kTiltSigma_rad = 0.005;
constexpr double kFreeShare = 0.3;       // of a free direction that is position
constexpr double kStanding_mps = 0.3;
constexpr int kStartLooks = 500'000;     // of the few searches for an unknown velocity
constexpr double kSkew_m = 0.01;         // a motion that turned out so far off: the scan is de-skewed anew
constexpr double kSkew_rad = 0.002;

/// base: x, y, yaw by right perturbation; R_odom_level of the pose.
Matrix6d in_space(const Eigen::Matrix3d& base, const Eigen::Matrix2d& R, double tilt_sigma_rad) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.topLeftCorner<2, 2>() = R * base.topLeftCorner<2, 2>() * R.transpose();
  covariance.block<2, 1>(0, 5) = R * base.block<2, 1>(0, 2);
  covariance.block<1, 2>(5, 0) = covariance.block<2, 1>(0, 5).transpose();
  covariance(2, 2) = kUnknownSigma_m * kUnknownSigma_m;
  covariance(3, 3) = covariance(4, 4) = tilt_sigma_rad * tilt_sigma_rad;
  covariance(5, 5) = base(2, 2);
  return covariance;
}

void tell_status(const LineMatch& match, const Eigen::Matrix2d& R, NavState& state) {
  state.reasons = match.ok ? 0 : bit(StatusReason::kFewInliers);
  state.degenerate_direction.setZero();
  if (match.ok && match.free_direction.head<2>().norm() > kFreeShare) {
    state.reasons |= bit(StatusReason::kDegenerateTranslation);
    state.degenerate_direction.head<2>() = (R * match.free_direction.head<2>()).normalized();
  }
  state.status = state.reasons == 0 ? TrackingStatus::kTracking : TrackingStatus::kDegraded;
}

}  // namespace

PlanarOdometry::PlanarOdometry(const VehicleGeometry& vehicle, const PlanarOdometryConfig& config)
    : config_{config},
      scan_2d_{vehicle, config.scan},
      tilt_{vehicle.T_base_imu.rotation, config.tilt},
      prior_{config.motion},
      map_{config.local_map} {}

void PlanarOdometry::add(const ImuSample& sample) {
  tilt_.add(sample, prior_.velocity().x());
  prior_.add_turn(sample.time, tilt_.yaw_rate());
}

const PlanarResult* PlanarOdometry::add(const LaserScan& scan) {
  scan_2d_.take(scan);
  return step();
}

const PlanarResult* PlanarOdometry::add(const Scan& scan) {
  scan_2d_.take(scan);
  return step();
}

const PlanarResult* PlanarOdometry::step() {
  if (prior_.has_estimate() && scan_2d_.end() <= prior_.time()) {
    ++stats_.out_of_order;
    return nullptr;
  }
  if (!prior_.has_estimate()) {
    begin_map();
    return scan_.points.empty() ? nullptr : &result_;
  }
  MotionPrior::Prediction prediction = prior_.predict(scan_2d_.begin(), scan_2d_.end());
  scan_2d_.cut(prediction.motion, tilt_.up_base(), scan_);
  if (scan_.points.empty()) {
    ++stats_.empty;
    return nullptr;
  }
  ++stats_.scans;
  LineMatch found = match(prediction.prior);
  if (found.ok) {
    const GroupSe2::Tangent off = GroupSe2::minus(found.T_map_base, prediction.motion.end());
    if (off.head<2>().norm() > kSkew_m || std::abs(off[2]) > kSkew_rad) {
      prediction.motion.bend(found.T_map_base);
      scan_2d_.cut(prediction.motion, tilt_.up_base(), scan_);
      const LineMatch again = match_lines(map_.lines(), scan_, found.T_map_base, prediction.prior, config_.matcher);
      if (again.ok) found = again;
    }
    matched_ = scan_2d_.end();
    unmatched_ = 0;
  } else {
    ++stats_.unmatched;
    if (++unmatched_ >= config_.max_unmatched) map_.clear();
  }
  const bool knew_velocity = prior_.knows_velocity();
  prior_.estimate(scan_2d_.end(), found.T_map_base, found.covariance, found.ok);
  // Scans from before were taken for those of a vehicle that stands.
  if (!knew_velocity && prior_.knows_velocity() && prior_.velocity().head<2>().norm() > kStanding_mps) map_.clear();
  tell(found);
  return &result_;
}

/// The first scan: odom begins where the vehicle is.
void PlanarOdometry::begin_map() {
  std::vector<PlanarPose> here(1);
  PlanarMotion still;
  still.assign(0.0, 0.0, here);
  scan_2d_.cut(still, tilt_.up_base(), scan_);
  if (scan_.points.empty()) {
    ++stats_.empty;
    return;
  }
  ++stats_.scans;
  matched_ = scan_2d_.end();
  prior_.estimate(scan_2d_.end(), PlanarPose{}, Eigen::Matrix3d::Zero(), true);
  LineMatch match;
  match.covariance.setZero();
  match.ok = true;
  match.inlier_share = 1.0;
  tell(match);
}

bool PlanarOdometry::is_sure(const PlanarPrior& prior) const {
  const Eigen::Matrix3d covariance = prior.information.inverse();
  return covariance.topLeftCorner<2, 2>().trace() < config_.sure_sigma_m * config_.sure_sigma_m &&
         covariance(2, 2) < config_.sure_sigma_rad * config_.sure_sigma_rad;
}

LineMatch PlanarOdometry::match(const PlanarPrior& prior) {
  LineMatch found = match_lines(map_.lines(), scan_, prior.T_map_base, prior, config_.matcher);
  if (!is_sure(prior) || !found.ok || found.inlier_share < config_.sure_inlier_share) {
    const LineMatch searched = match_lines(map_.lines(), scan_, search(prior), prior, config_.matcher);
    if (searched.ok && (!found.ok || searched.inlier_share > found.inlier_share)) found = searched;
  }
  found.ok = found.ok && found.inlier_share >= config_.least_inlier_share;
  if (!found.ok) {
    found.T_map_base = prior.T_map_base;
    found.covariance = prior.information.inverse();
  }
  return found;
}

PlanarPose PlanarOdometry::search(const PlanarPrior& prior) {
  const std::size_t stride = std::max<std::size_t>(1, (scan_.points.size() + config_.search_points - 1) / config_.search_points);
  sample_.clear();
  for (std::size_t i = 0; i < scan_.points.size(); i += stride) sample_.push_back(scan_.points[i]);
  const Eigen::Vector3d sigma = prior.information.inverse().diagonal().cwiseSqrt();
  SearchWindow window;
  window.centre = prior.T_map_base;
  const double sigma_m = sigma.head<2>().maxCoeff();
  const double most_m = prior_.knows_velocity() ? config_.most_search_m : config_.search_sigmas * sigma_m;
  window.half_width_m = std::clamp(config_.search_sigmas * sigma_m, config_.least_search_m, most_m);
  window.half_yaw_rad = std::min(config_.search_sigmas * sigma[2], config_.most_search_rad);
  window.centre_share = config_.search_centre_share;
  window.least_score = config_.least_score;
  window.most_looks = prior_.knows_velocity() ? config_.search_looks : kStartLooks;
  const std::optional<CorrelativeMatch> found = correlative_.match(map_.likelihood(), sample_, window);
  return found ? found->T_map_base : window.centre;
}

void PlanarOdometry::take_keyframe(double way_m) {
  const PlanarPose before = keyframe_.T_odom_base;
  keyframe_.id = keyframes_++;
  keyframe_.T_odom_base = prior_.pose();
  keyframe_.match_covariance = result_.match.covariance;
  const double renewed = std::min(1.0, way_m / map_.renewal_m());
  keyframe_.relative_covariance = renewed * result_.match.covariance;
  keyframe_.relative_covariance.diagonal() +=
      way_m * Eigen::Vector3d{config_.drift_m_rtm, config_.drift_m_rtm, config_.drift_rad_rtm}.cwiseAbs2();
  if (!result_.match.ok) keyframe_.relative_covariance = result_.match.covariance;
  keyframe_.inlier_share = result_.match.inlier_share;
  keyframe_.scan = scan_;
  const Eigen::Matrix3d ad = planar_adjoint((before.inverse() * keyframe_.T_odom_base).inverse());
  drift_ = ad * drift_ * ad.transpose() + keyframe_.relative_covariance;
  if (result_.match.ok || map_.is_empty()) map_.add(scan_, keyframe_.T_odom_base, way_m);
  result_.is_keyframe = true;
}

void PlanarOdometry::tell(const LineMatch& match) {
  result_.match = match;
  result_.is_keyframe = false;
  const GroupSe2::Tangent way = GroupSe2::minus(prior_.pose(), keyframe_.T_odom_base);
  const double far_m = std::max<double>(config_.keyframe_distance_m, config_.keyframe_ranges * scan_.mean_range_m);
  const bool is_far = way.head<2>().norm() >= far_m || std::abs(way[2]) >= config_.keyframe_angle_rad;
  if (map_.is_empty() || is_far) take_keyframe(keyframes_ == 0 ? 0.0 : way.head<2>().norm() + map_.turn_m() * std::abs(way[2]));
  NavState& state = result_.state;
  state.time = prior_.time();
  const PlanarPose& T = prior_.pose();
  const Eigen::Quaterniond R_odom_level{Eigen::AngleAxisd{T.yaw_rad, Eigen::Vector3d::UnitZ()}};
  state.T_odom_base.rotation = R_odom_level;
  state.T_odom_base.translation = {T.translation.x(), T.translation.y(), 0.0};
  state.velocity_mps = R_odom_level * Eigen::Vector3d{prior_.velocity().x(), prior_.velocity().y(), 0.0};
  state.angular_velocity_rads = {0.0, 0.0, prior_.velocity()[2]};
  const double lean_rad = tilt_.is_known() ? std::hypot(kTiltSigma_rad, tilt_.up_base().head<2>().norm()) : 1.0;
  state.covariance = in_space(drift_ + match.covariance, T.rotation(), lean_rad);
  tell_status(match, T.rotation(), state);
  if (to_seconds(state.time - matched_) > config_.lost_s) state.status = TrackingStatus::kLost;
}

}  // namespace slamd
