#pragma once
// A test fixture: the front end on a synthetic drive, whose events the test may spoil, and what can be said of the results.
// Asserts nothing itself.

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "estimator/odometry/lidar_inertial_odometry.hpp"
#include "tests/support/synthetic_drive.hpp"

namespace slamd::test {

inline bool has(const NavState& state, StatusReason reason) { return (state.reasons & bit(reason)) != 0U; }

inline OdometryConfig small_config() {
  OdometryConfig config;
  config.fusion.registration.map.max_voxels = 30'000;
  return config;
}

class OdometryRun : public ::testing::Test {
 protected:
  /// What becomes of an event at t seconds: false, it is lost; or it may be changed.
  using OnSample = std::function<bool(double, ImuSample&)>;
  using OnPacket = std::function<bool(double, LidarPacket&)>;
  static bool keep_sample(double, ImuSample&) { return true; }
  static bool keep_packet(double, LidarPacket&) { return true; }

  /// Goes on to to_s.
  void run(double to_s, const OnSample& on_sample = keep_sample, const OnPacket& on_packet = keep_packet) {
    drive_.play(
        now_s_, to_s,
        [&](ImuSample sample) {
          const HostTime arrival = sample.arrival;
          if (on_sample(SyntheticDrive::seconds(sample.time), sample)) odometry_.add(sample);
          take(arrival);
        },
        [&](LidarPacket packet) {
          const HostTime arrival = packet.arrival;
          if (on_packet(SyntheticDrive::seconds(packet.time), packet)) odometry_.add(packet);
          take(arrival);
        });
    now_s_ = to_s;
  }

  void take(HostTime now) {
    odometry_.advance(now);
    if (const ScanResult* result = odometry_.step()) results_.push_back(*result);
  }

  static double seconds(const ScanResult& result) { return SyntheticDrive::seconds(result.state.time); }

  const ScanResult& first_initialised(std::uint32_t odom_piece = 0) const {
    return *std::find_if(results_.begin(), results_.end(), [&](const ScanResult& r) {
      return r.state.odom_piece == odom_piece && r.state.status != TrackingStatus::kInitialising;
    });
  }

  /// Position error in odom, which the first tracked scan of its piece defines.
  Eigen::Vector3d position_error(const ScanResult& result) const {
    const ScanResult& first = first_initialised(result.state.odom_piece);
    const Pose T_odom_world = first.state.T_odom_base * drive_.T_world_base(first.state.time).inverse();
    return result.state.T_odom_base.translation - (T_odom_world * drive_.T_world_base(result.state.time)).translation;
  }

  /// From from_s on, of results with a scan.
  double worst_error(double from_s) const {
    double worst = 0.0;
    for (const ScanResult& result : results_)
      if (result.has_scan && seconds(result) >= from_s) worst = std::max(worst, position_error(result).norm());
    return worst;
  }

  /// The most that any told pose is wrong, in sigmas of its own covariance: 3 degrees of freedom.
  double worst_sigmas() const {
    double worst = 0.0;
    for (const ScanResult& result : results_) {
      if (result.state.status == TrackingStatus::kInitialising) continue;
      const Eigen::Vector3d error = position_error(result);
      const Eigen::Matrix3d covariance = result.state.covariance.topLeftCorner<3, 3>();
      worst = std::max(worst, std::sqrt(error.dot(covariance.ldlt().solve(error))));
    }
    return worst;
  }

  SyntheticDrive drive_;
  LidarInertialOdometry odometry_{drive_.vehicle(), small_config()};
  std::vector<ScanResult> results_;
  double now_s_ = 0.0;
};

}  // namespace slamd::test
