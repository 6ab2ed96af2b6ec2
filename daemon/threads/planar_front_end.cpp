#include "daemon/threads/planar_front_end.hpp"

#include "daemon/server/host_clock.hpp"

namespace slamd {
namespace {

constexpr double kVelocitySigma_mps = 0.1;        // of a scan's velocity,
constexpr double kVelocityWalk_mps_s = 0.5;       // and how it grows without one
constexpr double kGyroBiasSigma_rads = 0.005;     // nobody estimates the biases here
constexpr double kAccelBiasSigma_mps2 = 0.1;
constexpr double kGravitySigma_rad = 0.005;
constexpr Duration kTellPeriod = std::chrono::milliseconds{100};

Eigen::Matrix3d square(double sigma) { return sigma * sigma * Eigen::Matrix3d::Identity(); }

}  // namespace

FilterSnapshot snapshot_of(const NavState& state, const VehicleGeometry& vehicle, double velocity_sigma_mps) {
  FilterSnapshot snapshot;
  snapshot.time = state.time;
  const Pose T_odom_imu = state.T_odom_base * vehicle.T_base_imu;
  const Eigen::Vector3d swing = state.angular_velocity_rads.cross(vehicle.T_base_imu.translation);
  snapshot.state.R_odom_imu = T_odom_imu.rotation;
  snapshot.state.p_odom_imu = T_odom_imu.translation;
  snapshot.state.v_odom_imu = state.velocity_mps + state.T_odom_base.rotation * swing;
  snapshot.state.T_imu_lidar = vehicle.T_base_imu.inverse() * vehicle.T_base_lidar;
  const Eigen::Matrix3d R_imu_base = vehicle.T_base_imu.rotation.conjugate().toRotationMatrix();
  snapshot.angular_velocity_rads = R_imu_base * state.angular_velocity_rads;
  ErrorCovariance& P = snapshot.covariance;
  P.block<3, 3>(ErrorIndex::kPosition, ErrorIndex::kPosition) = state.covariance.topLeftCorner<3, 3>();
  P.block<3, 3>(ErrorIndex::kAttitude, ErrorIndex::kAttitude) =
      R_imu_base * state.covariance.bottomRightCorner<3, 3>() * R_imu_base.transpose();
  P.block<3, 3>(ErrorIndex::kVelocity, ErrorIndex::kVelocity) = square(velocity_sigma_mps);
  P.block<3, 3>(ErrorIndex::kGyroBias, ErrorIndex::kGyroBias) = square(kGyroBiasSigma_rads);
  P.block<3, 3>(ErrorIndex::kAccelBias, ErrorIndex::kAccelBias) = square(kAccelBiasSigma_mps2);
  P.block<2, 2>(ErrorIndex::kGravity, ErrorIndex::kGravity) = square(kGravitySigma_rad).topLeftCorner<2, 2>();
  return snapshot;
}

PlanarFrontEnd::PlanarFrontEnd(const PlanarFrontEndConfig& config, const VehicleGeometry& vehicle, Streams& streams)
    : config_{config},
      vehicle_{vehicle},
      streams_{streams},
      assembler_{config.assembler},
      odometry_{vehicle, config.odometry},
      predictor_{vehicle, config.dead_reckoning, config.imu} {}

void PlanarFrontEnd::add(const LidarPacket& packet) {
  if (!assembler_.add(packet)) return;
  assembler_.take(scan_);
  fuse(scan_);
}

void PlanarFrontEnd::add(const LaserScan& scan) { fuse(scan); }

void PlanarFrontEnd::add(const ImuSample& sample) {
  odometry_.add(sample);
  predictor_.add(sample);
  carry_on(sample.arrival);
}

template <class AnyScan>
void PlanarFrontEnd::fuse(const AnyScan& scan) {
  const HostTime begin = host_now();
  const PlanarResult* result = odometry_.add(scan);
  if (result == nullptr) return;
  const HostTime end = host_now();
  counts_.scan_time.record(end - begin);
  counts_.scan_latency.record(end - result->state.time);
  counts_.scans.fetch_add(1, std::memory_order_relaxed);
  newest_ = result->state;
  publish(result->state);
  streams_.path.try_push({result->state.time, result->state.T_odom_base});
  if (result->is_keyframe) offer_keyframe();
}

void PlanarFrontEnd::publish(const NavState& state) {
  const double silent_s = to_seconds(state.time - newest_->time);
  Posterior& posterior = streams_.posterior.back();
  posterior.snapshot = snapshot_of(state, vehicle_, kVelocitySigma_mps + kVelocityWalk_mps_s * silent_s);
  posterior.state = state;
  predictor_.correct(posterior.snapshot, state);
  streams_.posterior.publish();
}

/// One that finds the ring full is left out, and the next one's relation is the less sure.
void PlanarFrontEnd::offer_keyframe() {
  PlanarKeyframe* slot = streams_.planar_keyframes.claim();
  if (slot == nullptr) {
    left_out_ += odometry_.keyframe().relative_covariance;
    return;
  }
  *slot = odometry_.keyframe();
  slot->id = counts_.keyframes.fetch_add(1, std::memory_order_relaxed);
  slot->relative_covariance += left_out_;
  left_out_.setZero();
  streams_.planar_keyframes.commit();
}

/// Scans stay away: the pose goes on without them and says so.
void PlanarFrontEnd::carry_on(HostTime now) {
  if (!newest_ || now - newest_->time < config_.lidar_silence || now - told_ < kTellPeriod) return;
  told_ = now;
  NavState state = predictor_.coast_to(now);
  state.reasons |= bit(StatusReason::kNoLidar);
  const bool is_lost = to_seconds(now - newest_->time) > config_.odometry.lost_s;
  state.status = is_lost ? TrackingStatus::kLost : TrackingStatus::kDegraded;
  publish(state);
}

}  // namespace slamd
