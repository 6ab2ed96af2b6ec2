#include "daemon/app_parts.hpp"

#include <utility>

#include "daemon/server/host_clock.hpp"
#include "daemon/threads/planar_front_end.hpp"
#include "daemon/threads/spatial_front_end.hpp"

namespace slamd {
namespace {

constexpr double kFastest_mps = 100.0;  // that a vehicle is believed to have gone

}  // namespace

Config with_what_was_learnt(Config config, const Result<StoredMap>& left) {
  if (!left || left->keyframes.empty()) return config;
  const StoredSensors& sensors = left->sensors;
  const auto is_sound = [](const Eigen::Vector3d& bias) { return bias.cwiseAbs().maxCoeff() <= kMostKnownBias; };
  if (!is_sound(sensors.gyro_bias_rads) || !is_sound(sensors.accel_bias_mps2)) return config;
  InitialisationConfig& start = config.odometry.start.initialisation;
  start.known_gyro_bias_rads = sensors.gyro_bias_rads;
  start.known_accel_bias_mps2 = sensors.accel_bias_mps2;
  if (config.odometry.fusion.registration.update.estimate_extrinsic) {
    config.vehicle.T_base_lidar = config.vehicle.T_base_imu * sensors.T_imu_lidar;
  }
  if (left->motion && left->motion->velocity_mps.norm() < kFastest_mps) {
    const Eigen::Vector3d up = left->T_map_base.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    start.known_motion = {to_seconds(left->motion->time.time_since_epoch()), left->motion->velocity_mps, up};
  }
  return config;
}

std::unique_ptr<FrontEnd> make_front_end(const Config& config, Streams& streams) {
  if (config.mode == "planar") {
    const OdometryConfig& odometry = config.odometry;
    const PlanarFrontEndConfig planar{config.planar.odometry, odometry.scans.assembler, odometry.dead_reckoning, odometry.imu};
    return std::make_unique<PlanarFrontEnd>(planar, config.vehicle, streams);
  }
  const EstimatorThreadConfig& thread = config.estimator;
  return std::make_unique<SpatialFrontEnd>(SpatialFrontEndConfig{thread.budget, thread.merge.hold_back}, config.vehicle, config.odometry,
                                           streams);
}

Result<StoredMap> by_this_clock(Result<StoredMap> left) {
  constexpr Duration kSameClock = std::chrono::seconds{1};
  if (!left || !left->motion || std::chrono::abs(left->motion->host_to_utc - host_to_utc()) < kSameClock) return left;
  StoredMap map = std::move(left).value();
  map.motion.reset();
  return map;
}

}  // namespace slamd
