#pragma once
// A drive in a closed room as the front end's events: exact motion, IMU and LiDAR sampled from it. No wire bytes and no
// sensor's details: tools/slam-sim has those.

#include <algorithm>

#include "estimator/math/lie.hpp"
#include "estimator/types/imu_sample.hpp"
#include "estimator/types/pose.hpp"
#include "tests/support/random_states.hpp"
#include "tests/support/spinning_lidar.hpp"

namespace slamd::test {

/// The reference vehicle.
inline VehicleGeometry reference_vehicle() {
  return {.T_base_lidar = {Eigen::Quaterniond{0.9953961984, 0.0, 0.0958457525, 0.0}, {0.45, 0.02, 1.86}},
          .T_base_imu = {Eigen::Quaterniond{0.699404695268, 0.019093388559, 0.003285447570, 0.714463239491}.normalized(),
                         {0.12, -0.08, 1.52}},
          .p_base_antenna = {-0.60, 0.35, 1.74}};
}

/// Rests until start_s, then swings about in the room without ever leaving it; negative start_s: begins in motion.
struct SwingingMotion {
  double start_s = 1.5;

  Pose T_world_base(double t) const {
    const double s = std::max(0.0, t - start_s);
    const double ramp = s * s / (1.0 + s * s);  // smooth begin of every rate
    const Eigen::Quaterniond rotation =
        exp_so3({0.0, 0.0, 0.6 * ramp * std::sin(0.5 * s)}) * exp_so3({0.03 * ramp * std::sin(2.0 * s), 0.02 * ramp, 0});
    return {rotation, ramp * Eigen::Vector3d{2.0 * std::sin(0.6 * s), 1.5 * std::sin(0.4 * s), 0.05 * std::sin(3.0 * s)}};
  }
};

/// A room 16 m x 12 m, 5 m high, with a pillar: what a ray hits first.
inline double cast_in_room(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d low{-7.0, -5.0, 0.0}, high{9.0, 7.0, 5.0};
  double range = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    if (direction[i] == 0.0) continue;
    range = std::min(range, ((direction[i] > 0.0 ? high : low)[i] - from[i]) / direction[i]);
  }
  const Eigen::Vector3d pillar_low{4.0, 3.5, 0.0}, pillar_high{5.0, 4.5, 5.0};
  double enter = 0.0, leave = range;
  for (int i = 0; i < 2; ++i) {
    const double a = (pillar_low[i] - from[i]) / direction[i], b = (pillar_high[i] - from[i]) / direction[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter < leave ? enter : range;
}

class SyntheticDrive {
 public:
  explicit SyntheticDrive(const SwingingMotion& motion = {}) : motion_{motion} {}

  static HostTime at(double t) { return from_ns<HostTime>(1'000'000'000) + from_seconds(t); }
  static double seconds(HostTime time) { return to_seconds(time - at(0.0)); }

  Pose T_world_base(HostTime time) const { return motion_.T_world_base(seconds(time)); }

  ImuSample imu(std::int64_t index) const {
    constexpr double kStep_s = 1e-3;
    const double t = 0.005 * static_cast<double>(index);
    const Pose T_base_imu = vehicle_.T_base_imu;
    const Pose before = motion_.T_world_base(t - kStep_s) * T_base_imu, now = motion_.T_world_base(t) * T_base_imu,
               after = motion_.T_world_base(t + kStep_s) * T_base_imu;
    const Eigen::Vector3d accel =
        (after.translation - 2.0 * now.translation + before.translation) / (kStep_s * kStep_s);
    Random random{static_cast<std::uint64_t>(index) + 1'000'000U};
    ImuSample out;
    out.time = at(t);
    out.arrival = out.time + std::chrono::microseconds{300};
    out.gyro_rads = log_so3(before.rotation.conjugate() * after.rotation) / (2.0 * kStep_s) + gyro_bias_ +
                    normal3(random, 0.002);
    out.accel_mps2 = now.rotation.conjugate() * (accel + Eigen::Vector3d{0, 0, 9.80665}) + accel_bias_ +
                     normal3(random, 0.02);
    return out;
  }

  LidarPacket packet(std::int64_t index) const {
    Random random{static_cast<std::uint64_t>(index)};
    return lidar_.packet(index, [&](HostTime time, const Eigen::Vector3d& direction) {
      const Pose T_world_lidar = T_world_base(time) * vehicle_.T_base_lidar;
      return cast_in_room(T_world_lidar.translation, T_world_lidar.rotation * direction) + normal(random, 0.01);
    });
  }

  const VehicleGeometry& vehicle() const { return vehicle_; }

  /// Hands the events of [from_s, to_s) in order of arrival to on_imu and on_packet.
  template <class OnImu, class OnPacket>
  void play(double from_s, double to_s, const OnImu& on_imu, const OnPacket& on_packet) const {
    std::int64_t next_imu = std::llround(std::ceil(from_s / 0.005 - 1e-9));
    std::int64_t next_packet = std::llround(std::ceil(from_s / SpinningLidar::kPacket_s - 1e-9));
    while (true) {
      const double imu_arrival_s = 0.005 * static_cast<double>(next_imu) + 0.0003;
      const double packet_arrival_s = static_cast<double>(next_packet + 1) * SpinningLidar::kPacket_s + 0.00003;
      if (std::min(imu_arrival_s, packet_arrival_s) >= to_s) return;
      if (imu_arrival_s < packet_arrival_s) {
        on_imu(imu(next_imu++));
      } else {
        on_packet(packet(next_packet++));
      }
    }
  }

 private:
  SwingingMotion motion_;
  VehicleGeometry vehicle_ = reference_vehicle();
  SpinningLidar lidar_{600.0, 17.0, at(0.0)};
  Eigen::Vector3d gyro_bias_{0.004, -0.003, 0.002};
  Eigen::Vector3d accel_bias_{0.03, -0.04, 0.05};
};

}  // namespace slamd::test
