#include "estimator/odometry/starter.hpp"

namespace slamd {

Starter::Starter(const VehicleGeometry& geometry, const StarterConfig& config)
    : T_base_imu_{geometry.T_base_imu},
      T_imu_lidar_{geometry.T_base_imu.inverse() * geometry.T_base_lidar},
      config_{config},
      initialisation_{config.initialisation} {}

void Starter::add(const ImuSample& sample) {
  if (!done_) initialisation_.add(sample);
}

void Starter::clear() {
  initialisation_.clear();
  first_scan_.reset();
  done_ = false;
}

std::optional<InitialState> Starter::state(const Scan& scan, bool imu_is_alive, bool with_extrinsic) {
  if (!first_scan_) first_scan_ = scan.begin;
  if (imu_is_alive) {
    if (!initialisation_.is_ready()) return std::nullopt;
    done_ = true;
    return initialisation_.state(scan.begin, T_base_imu_, T_imu_lidar_, with_extrinsic);
  }
  if (scan.end - *first_scan_ < from_seconds(config_.imu_grace_s)) return std::nullopt;
  done_ = true;
  return initial_state_without_imu(scan.begin, config_.initialisation, T_base_imu_, T_imu_lidar_);
}

}  // namespace slamd
